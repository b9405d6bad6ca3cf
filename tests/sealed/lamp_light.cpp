#include "lamp_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fathom::sealed {
namespace {

constexpr double kGrid_px = 16;  // the glow changes over a hundred pixels
constexpr int kRanges = 144;     // at which it is kept
constexpr double kFirstRange_m = 0.02, kLastRange_m = 40.0;
constexpr int kStepsPerRange = 2;

/// A white scene's light under what the data sheet's irradiance is relative to.
constexpr double kWhiteInDaylight = 0.87;

/// Ranges grow by a constant factor: the integrand changes over its distance from the lamps.
double rangeOf(double index) {
  return kFirstRange_m * std::pow(kLastRange_m / kFirstRange_m, index / (kRanges - 1));
}
double indexOf(double range_m) {
  return (kRanges - 1) * std::log(range_m / kFirstRange_m) / std::log(kLastRange_m / kFirstRange_m);
}

}  // namespace

/// Endless water turns daylight E into a veil b, at the rate a of the first metre: it scatters a b / E of an
/// irradiance a metre, towards the camera as much as anywhere where it scatters alike in all directions.
/// Daylight comes from everywhere: what it brings does not depend on that.
LampLight::LampLight(const Vehicle& vehicle, double irradiance_1m, const WaterLight& water,
                     const Array3d& daylight, const SightLines& sight, PhaseFunction phase,
                     double beam_exponent)
    : irradiance_1m_(irradiance_1m),
      beam_exponent_(beam_exponent),
      phase_(std::move(phase)),
      water_(water),
      scattering_per_m_(water.veil_attenuation_per_m * water.veil / daylight) {
  if (!shines()) return;
  const Pose T_camera_robot = vehicle.camera.pose.pose().inverse();
  for (const Lamp& lamp : vehicle.lamps) {
    const Pose T_camera_lamp = T_camera_robot * lamp.pose.pose();
    beams_.push_back(
        {T_camera_lamp.position, T_camera_lamp.rotation.col(0), std::cos(radians(lamp.half_angle_deg))});
  }
  march(sight);
}

/// Inverse square, attenuation on the way, and a beam that is half as bright at its half angle (Jaffe 1990,
/// eqs. 1 to 3; the profile is von Mises and Fisher's).
Array3d LampLight::fromLamp(const Beam& beam, const Vector3d& point_camera) const {
  const Vector3d way = point_camera - beam.position_camera;
  const double distance_m = way.norm(), cosine = way.dot(beam.axis_camera) / distance_m;
  const double profile = beam_exponent_ > 0 ? std::pow(std::max(0.0, cosine), beam_exponent_)
                                            : std::exp2(-(1 - cosine) / (1 - beam.half_angle_cosine));
  return irradiance_1m_ * kWhiteInDaylight * profile / (distance_m * distance_m) *
         (-water_.attenuation_per_m * distance_m).exp();
}

Array3d LampLight::irradianceAt(const Vector3d& point_camera) const {
  Array3d sum = Array3d::Zero();
  for (const Beam& beam : beams_) sum += fromLamp(beam, point_camera);
  return sum;
}

Array3d LampLight::irradianceOn(const Vector3d& point_camera, const Vector3d& normal_camera) const {
  Array3d sum = Array3d::Zero();
  for (const Beam& beam : beams_) {
    const Vector3d to_lamp = (beam.position_camera - point_camera).normalized();
    sum += std::max(0.0, normal_camera.dot(to_lamp)) * fromLamp(beam, point_camera);
  }
  return sum;
}

Array3d LampLight::scattered(const Vector3d& point_camera, double range_m) const {
  Array3d to_camera = Array3d::Zero();
  for (const Beam& beam : beams_) {
    const double cosine = -(point_camera - beam.position_camera).normalized().dot(point_camera.normalized());
    to_camera += fromLamp(beam, point_camera) * phase_(cosine);
  }
  return scattering_per_m_ * to_camera * water_.transmission(water_.path_m(point_camera.z(), range_m));
}

/// Single scattering (Jaffe 1990, eqs. 4 to 7), summed up along the line of sight by the midpoint rule.
void LampLight::march(const SightLines& sight) {
  columns_ = static_cast<int>(sight.width_px() / kGrid_px) + 2;
  rows_ = static_cast<int>(sight.height_px() / kGrid_px) + 2;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const Ray ray = sight.at({column * kGrid_px, row * kGrid_px});
      const Vector3d direction = ray.direction.normalized();
      Array3d sum =
          scattered(ray.origin + direction * (kFirstRange_m / 2), kFirstRange_m / 2) * kFirstRange_m;
      glow_.push_back(sum);
      for (int step = 0; step < (kRanges - 1) * kStepsPerRange; ++step) {
        const double from_m = rangeOf(static_cast<double>(step) / kStepsPerRange);
        const double to_m = rangeOf(static_cast<double>(step + 1) / kStepsPerRange);
        const double middle_m = (from_m + to_m) / 2;
        sum += scattered(ray.origin + direction * middle_m, middle_m) * (to_m - from_m);
        if (step % kStepsPerRange == kStepsPerRange - 1) glow_.push_back(sum);
      }
    }
}

/// Linear between pixels of the grid and ranges.
Array3d LampLight::glow(const Vector2d& pixel, double range_m) const {
  if (!shines()) return Array3d::Zero();
  const double x = std::clamp(pixel.x() / kGrid_px, 0.0, columns_ - 1.001);
  const double y = std::clamp(pixel.y() / kGrid_px, 0.0, rows_ - 1.001);
  const double k = std::clamp(indexOf(range_m), 0.0, kRanges - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y), range = static_cast<int>(k);
  const auto at = [&](int r, int c, int i) -> const Array3d& {
    return glow_[static_cast<std::size_t>((r * columns_ + c) * kRanges + i)];
  };
  const auto along = [&](int r, int c) -> Array3d {
    return at(r, c, range) + (k - range) * (at(r, c, range + 1) - at(r, c, range));
  };
  const auto across = [&](int r) -> Array3d {
    return (column + 1 - x) * along(r, column) + (x - column) * along(r, column + 1);
  };
  return (row + 1 - y) * across(row) + (y - row) * across(row + 1);
}

}  // namespace fathom::sealed
