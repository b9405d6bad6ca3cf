#include "support/traced_light.h"

#include <cmath>
#include <numbers>

namespace fathom::test {

Vector3d refracted(const Vector3d& direction, const Vector3d& normal, double n1, double n2) {
  const double ratio = n1 / n2, cosine = direction.dot(normal);
  return ratio * direction + (std::sqrt(1 - ratio * ratio * (1 - cosine * cosine)) - ratio * cosine) * normal;
}

LightRay traced(const FlatPort<double>& port, const Vector3d& sight) {
  const Vector3d normal = expSO3<double>(Vector3d(port.tilt_x_rad, port.tilt_y_rad, 0)) * Vector3d::UnitZ();
  const double nominal_index = 1.34 / (1 + port.index_error);
  const Vector3d air = refracted(sight.normalized(), normal, nominal_index, 1.0);
  const Vector3d at_glass = port.distance_m / air.dot(normal) * air;
  const Vector3d glass = refracted(air, normal, 1.0, 1.5);
  const Vector3d at_water = at_glass + port.glass_m / glass.dot(normal) * glass;
  return {at_water, refracted(glass, normal, 1.5, 1.34)};
}

/// Light's way through concentric spheres without any vector of Snell's law: n times the line's distance from
/// their centre stays the same (Bouguer), and between two radii it turns about the centre by acos(d / r).
LightRay traced(const DomePort<double>& dome, const Vector3d& sight) {
  const double outer_m = 0.075 * std::exp(dome.log_radius), inner_m = outer_m - dome.glass_m;
  const Vector3d nearest = sight * sight.dot(dome.centre_m) - dome.centre_m;  // from the centre to the line
  const double air_m = nearest.norm(), glass_m = air_m / 1.5, water_m = air_m / 1.34;
  const double at_water =
      std::acos(air_m / inner_m) + std::acos(glass_m / outer_m) - std::acos(glass_m / inner_m);
  const double beside = at_water - std::acos(water_m / outer_m);
  const auto inPlane = [&](double angle) {
    return Vector3d(std::cos(angle) * nearest / air_m + std::sin(angle) * sight);
  };
  return {dome.centre_m + outer_m * inPlane(at_water), inPlane(beside + std::numbers::pi / 2)};
}

}  // namespace fathom::test
