#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstddef>
#include <optional>

#include "effects/registry.h"
#include "estimation/motion.h"
#include "imaging/water.h"

namespace fathom {

inline constexpr std::size_t kEffectScalars = kEffectOffsets[kEffectCount];

/// What is not quite as rendered in any camera's images: by how many px² lens and pixels blur more, to all
/// sides; how many of the smallest specks an image has that nothing made; and what is read besides the light
/// in red and the two behind it, as a share of full scale.
enum ImageFlaw { kLensBlur, kFalseSpecks, kFalseLight };
inline constexpr int kFlaws = kFalseLight + 3;
using Flaws = Eigen::Matrix<double, kFlaws, 1>;

/// Columns of a prediction's derivative: the motion's (MotionColumn), the panel's pose (position in odom, m;
/// rotation vector in panel axes, rad), the right camera's pose likewise in the left one's frame, the water
/// (waterParameters()), the images' flaws (ImageFlaw), the sea floor's height, then the scalars of all
/// effects.
inline constexpr int kPanelColumn = kMotionSize;
inline constexpr int kRightColumn = kPanelColumn + 6;
inline constexpr int kWaterColumn = kRightColumn + 6;
inline constexpr int kFlawColumn = kWaterColumn + 9;
inline constexpr int kFloorColumn = kFlawColumn + kFlaws;
inline constexpr int kEffectColumn = kFloorColumn + 1;

/// All that a prediction depends on.
struct ForwardPoint {
  Motion motion;
  /// The motion is that at the stamp + so much. Where the effects' validity is another one it is carried on,
  /// at constant jerk.
  double validity_s = 0.0;
  /// The INS's latency with which knots are where they are, see knotEffect(): of another one the motion comes
  /// so much later. Nothing: they do not follow it.
  std::optional<double> knot_latency_s;
  Pose T_odom_panel, T_left_right;
  Vector3d first_panel_odom = Vector3d::Zero();  ///< see PanelPlacement
  Vector9d water = Vector9d::Zero();
  Flaws flaws = Flaws::Zero();
  double sea_floor_z_m = 0.0;
  std::array<double, kEffectScalars> effects{};
  std::bitset<kEffectCount> on;  ///< those that act, and those by which is differentiated
};

}  // namespace fathom
