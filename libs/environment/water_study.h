#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "environment/fsim_search.h"
#include "environment/image_choice.h"
#include "environment/panel_pose_check.h"
#include "environment/water_fit.h"
#include "environment/water_scores.h"

/// Task T_E on a recording: the water fitted to some of its images, the paper's search as baseline, and both
/// judged on images that neither has seen.
namespace fathom {

struct WaterStudyOptions {
  ImageChoiceOptions choice;
  WaterFitOptions fit;  ///< its start is the default water
  FsimSearchOptions search;
  std::size_t search_images = 5;
  PanelPoseCheckOptions panel_poses;
  std::uint64_t seed = 1;
};

struct WaterStudy {
  std::size_t images = 0, posed = 0;  ///< of the recording
  ImageChoice choice;
  SynchronizedImages synchronized;
  std::optional<int> jpeg_quality;
  WaterFit fit;
  FsimSearch search;
  std::vector<WaterCandidate>
      candidates;               ///< default, the paper's search, fitted, and where it is known truth
  std::size_t recommended = 0;  ///< one of the first three
  std::optional<Environment> truth;
  std::optional<PanelPoseCheck> panel_poses;  ///< under the recommended water
  cv::Mat sheet;                              ///< CV_8UC3: some held-out images as recorded and in each water
  std::vector<std::string> remarks;

  const WaterCandidate& recommendedWater() const { return candidates[recommended]; }
};

/// `maker` renders, with the effects of its world, which the images must have been posed with; its
/// environment does not matter, lamps are off but for effects. Throws Error where no image can be used: no
/// marker in any, or none fits its pose (the first one's reason); Interrupted.
WaterStudy studyWater(const std::filesystem::path& rawlog, const PosedImages& images, const PairMaker& maker,
                      const WaterStudyOptions& options);

/// A water file that readEnvironment() takes; `comment` becomes its first lines.
std::string formatEnvironment(const Environment& environment, const std::string& comment);

}  // namespace fathom
