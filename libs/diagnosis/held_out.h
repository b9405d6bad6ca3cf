#pragma once

#include <array>
#include <string>
#include <vector>

#include "estimation/batch_data.h"

namespace fathom {

/// Root mean square of one channel's residuals on stretches that the fit did not see; there only poses are
/// estimated again.
struct HeldOut {
  BatchChannel channel = BatchChannel::prior;
  std::string metric;  ///< "reprojection_rms_px", "dvl_rms_m_s", …
  double before = 0, after = 0;
  std::array<double, 2> after_ci95{};
  double black_box = 0;               ///< with splines over the covariates instead of physics
  double noise_floor = 0;             ///< what noise alone makes of it
  double log_likelihood_gain = 0;     ///< of all channels, after over before
  std::array<double, 2> gain_ci95{};  ///< block bootstrap
  double black_box_log_likelihood_gain = 0;
  double placebo_log_likelihood_gain = 0;  ///< 95th percentile of the best of all on simulated nulls
  struct Block {
    double from_s = 0, to_s = 0;
    double before = 0, after = 0, black_box = 0;  ///< rms
  };
  std::vector<Block> blocks;
};

}  // namespace fathom
