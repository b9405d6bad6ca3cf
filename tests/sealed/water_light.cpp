#include "water_light.h"

#include <array>
#include <cmath>
#include <numbers>

namespace fathom::sealed {
namespace {

constexpr double kPlumeWidth_s = 10.0;
constexpr double kCloudHalfway = 0.5;  // between camera and panel
const Vector3d kCloudDrift_odom_m_s(0.01, 0.06, 0.008);

struct Water {
  const char* name;
  Array3d attenuation_per_m, veil, daylight;
};

/// Clear: some way off the coast, Jerlov's oceanic types; turbid: his coastal types 3 to 5 (Jerlov 1976,
/// tables XXVI and XXVII, roughly, at 620, 540 and 460 nm). Daylight is 0.87 in the mean of its colours.
const Water& waterNamed(const std::string& name) {
  static const std::array<Water, 3> waters{
      {{"clear", {0.35, 0.10, 0.08}, {0.025, 0.150, 0.215}, {0.80, 0.90, 0.91}},
       {"moderate", {0.45, 0.22, 0.20}, {0.035, 0.180, 0.200}, {0.80, 0.90, 0.91}},
       {"turbid", {0.85, 0.50, 0.56}, {0.050, 0.220, 0.200}, {0.80, 0.92, 0.89}}}};
  for (const Water& water : waters)
    if (name == water.name) return water;
  return waters[0];
}

/// A diffusing puff that drifts past (Fischer et al. 1979, sec. 2.3): Gaussian in time.
double plume_per_m(const SealedCase& sealed, double t_s) {
  if (sealed.number("turbidity-plume", "cloud_m", t_s) > 0) return 0;
  const double width_s = kPlumeWidth_s * std::exp(sealed.number("turbidity-plume", "log_width", t_s));
  const double widths_off = (t_s - sealed.number("turbidity-plume", "time_s", t_s)) / width_s;
  return sealed.number("turbidity-plume", "peak_extra_attenuation_per_m", t_s) *
         std::exp(-widths_off * widths_off / 2);
}

}  // namespace

/// The integral of a Gaussian along a straight line.
double MurkyCloud::opticalDepth(const Eigen::Vector3d& from_camera, const Eigen::Vector3d& to_camera) const {
  if (peak_per_m == 0) return 0;
  const double length_m = (to_camera - from_camera).norm();
  const Eigen::Vector3d direction = (to_camera - from_camera) / length_m;
  const double nearest_m = (middle_camera - from_camera).dot(direction);
  const double off_m2 = (middle_camera - from_camera).squaredNorm() - nearest_m * nearest_m;
  const double scale_m = std::numbers::sqrt2 * sigma_m;
  const double part = std::erf((length_m - nearest_m) / scale_m) + std::erf(nearest_m / scale_m);
  return peak_per_m * std::exp(-off_m2 / (scale_m * scale_m)) * sigma_m * std::sqrt(std::numbers::pi / 2) *
         part;
}

MurkyCloud murkyCloudAt(const SealedCase& sealed, const Viewpoint& viewpoint, const Vector3d& panel_odom,
                        double stamp_s) {
  MurkyCloud cloud;
  cloud.sigma_m = sealed.number("turbidity-plume", "cloud_m", stamp_s);
  if (cloud.sigma_m == 0) return cloud;
  cloud.peak_per_m = sealed.number("turbidity-plume", "peak_extra_attenuation_per_m", stamp_s);
  const double peak_s = sealed.number("turbidity-plume", "time_s", stamp_s);
  const Vector3d camera_odom = viewpoint.T_odom_camera(peak_s, stamp_s).position;
  const double taken_s = viewpoint.trueTime_s(stamp_s);
  const Vector3d middle_odom =
      camera_odom + kCloudHalfway * (panel_odom - camera_odom) + kCloudDrift_odom_m_s * (taken_s - peak_s);
  cloud.middle_camera = viewpoint.T_odom_camera(taken_s, stamp_s).inverse() * middle_odom;
  return cloud;
}

WaterLight waterLightAt(const SealedCase& sealed, double t_s, double log_sun) {
  const Water& water = waterNamed(sealed.dive.water);
  WaterLight light;
  light.attenuation_per_m = water.attenuation_per_m + plume_per_m(sealed, t_s);
  light.veil_attenuation_per_m =
      light.attenuation_per_m +
      sealed.vector("separate-backscatter", "backscatter_difference_per_m", t_s).array();
  light.veil = water.veil;
  light.daylight = water.daylight * std::exp(log_sun * sealed.number("sun-flicker", "log_light_sd", t_s));
  light.slant_share = sealed.number("slant-range", "slant_share", t_s);
  light.scattered_fraction = sealed.number("forward-scatter", "scattered_fraction", t_s);
  return light;
}

}  // namespace fathom::sealed
