#pragma once

#include <optional>

#include "environment/water_scores.h"
#include "evaluation/panel_evaluation.h"

namespace fathom {

/// Task T_P under a fitted water, beside the recording: the panel's pose error that `fathom evaluate panel`
/// finds at the very views of the recording, with the effects of the world, and the one that the recording's
/// own images have against its truth. Neither estimate knows of effects.
struct PanelPoseCheck {
  /// Of the same views, in order; those where either has no pose, or says that it is
  /// ambiguous, do not count below.
  std::vector<PanelViewResult> expected, measured;

  MeanScore joint(const std::vector<PanelViewResult>& results, double PanelPoseError::*measure) const;
  MeanScore averaged(const std::vector<PanelViewResult>& results, double PanelPoseError::*measure) const;
};

/// Whether the intervals of two independent means allow that they are the same (Welch).
bool agree(const MeanScore& a, const MeanScore& b);

struct PanelPoseCheckOptions {
  std::size_t views = 200;  ///< of the recording's posed images, evenly spread
  std::uint64_t seed = 1;
  std::optional<int> jpeg_quality;
  Backend backend = Backend::apriltag;
};

/// Nothing where the recording has no truth, or its map several panels.
std::optional<PanelPoseCheck> checkPanelPoses(const std::filesystem::path& rawlog,
                                              const std::vector<PosedImage>& posed, const KnownWorld& world,
                                              const Environment& water, const PanelPoseCheckOptions& options);

}  // namespace fathom
