#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/whitened_model.h"

/// Does it fit on data that the fit had not seen?
namespace fathom {

/// Root mean square of one channel's residuals on stretches that the fit did not see. Only the effects'
/// parameters are carried over: all that is estimated in any case is estimated again there.
struct HeldOut {
  Channel channel = kChannel<Prior>;
  std::string metric;  ///< "reprojection_rms_px", "dvl_rms_mm_s", …
  double before = 0, after = 0;
  std::array<double, 2> after_ci95{};  ///< by block bootstrap
  double black_box = 0;                ///< with splines over the covariates instead of physics
  double noise_floor = 0;              ///< what noise alone makes of it
  struct Block {
    double from_s = 0, to_s = 0;
    double before = 0, after = 0, black_box = 0;  ///< rms
  };
  std::vector<Block> blocks;  ///< none of a single image, of which markers are held out
};

/// ln of the predictive density of what is held out, given all the rest, over that of the model with nothing
/// added; all channels.
struct HeldOutGain {
  double physics = 0, black_box = 0;
  std::vector<double> by_effect;  ///< what each adds to all the others
  /// What each would add on average, were it as it was trained: where poses that are estimated anew follow an
  /// effect, held-out stretches show less of it than the whole recording does. At most what it changes there
  /// by itself: one that takes an outlier away makes the others' values better everywhere, and is none.
  std::vector<double> expected_by_effect;
  /// By what a true effect's gain scatters about that, at most: a fold's, ln of a ratio of likelihoods of
  /// normal noise, by the root of twice what is expected of it; and folds may all do so alike, since all are
  /// told of by the same nuisances.
  std::vector<double> scatter_by_effect;
  std::array<double, 2> physics_ci95{};  ///< by block bootstrap
  std::array<double, 2> over_black_box_ci95{};
  double placebo = 0;  ///< 95th percentile of what the best of all effects gains where nothing is missing
};

struct HeldOutResult {
  std::vector<HeldOut> channels;  ///< those that the effects act on most first
  HeldOutGain gain;
};

struct HeldOutOptions {
  int folds = 5;
  bool yardsticks = true;  ///< black box, placebo and noise floor too
  std::uint64_t seed = 1;
};

/// How long a stretch is that is held out at once; 0 of a single image.
double heldOutStretch_s(const BatchData& data, const HeldOutOptions& options);

/// `linear`: not weighted; `found`: the state there, in which what is drawn for each image scatters as it was
/// found to. A fold is every so-manyth stretch of the recording, of a single image so many markers; effects
/// are trained on all others.
HeldOutResult holdOut(const Linearization& linear, const std::vector<Candidate>& effects,
                      const BatchState& found, const NoiseModel& noise, const BatchData& data,
                      const HeldOutOptions& options);

}  // namespace fathom
