#pragma once

#include <array>
#include <bitset>
#include <optional>

#include "core/geometry.h"
#include "effects/registry.h"
#include "estimation/batch_data.h"

/// What a batch problem takes for granted: which effects are unknown, how much readings scatter, how a
/// vehicle moves.
namespace fathom {

struct PathPrior {
  Pose T_odom_robot;  ///< at the path's beginning
  double position_sigma_m = 100.0, heading_sigma_rad = 3.0;
};

/// Every channel's sigma as the data sheet has it.
constexpr std::array<double, kChannelCount> asStated() {
  std::array<double, kChannelCount> ones{};
  ones.fill(1);
  return ones;
}

struct ProblemOptions {
  /// Effects whose continuous parameters are estimated, starting from the state's.
  std::bitset<kEffectCount> estimate;
  /// Sigma of each channel in units of the data sheet's (or of a corner's own covariance), by Channel.
  std::array<double, kChannelCount> noise_scale = asStated();
  /// By what share of their light patches scatter besides.
  double light_scatter = 0;
  /// Huber's loss for DVL, USBL and markers, beyond what a reading's chi-square exceeds with probability
  /// 1 - this; 1: none. Generous, so that what is out of place keeps most of its weight.
  double robust_probability = 0.99999;
  /// What keeps stretches without an INS from being singular: a vehicle hardly accelerates more than this
  /// (one sigma, white, each knot). With an INS its weight is 1e-5 of the INS's.
  double acceleration_sigma_m_s2 = 1.0, angular_acceleration_sigma_rad_s2 = 1.0;
  std::optional<PathPrior> path_prior;  ///< absent: as StartPath::prior() says
};

}  // namespace fathom
