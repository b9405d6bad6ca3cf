#pragma once

#include <cmath>
#include <vector>

#include "core/gauss_legendre.h"
#include "imaging/water.h"
#include "sensors/vehicle.h"

/// What the vehicle's lamps do, each of irradiance 1 on its axis at 1 m without water, in units of full
/// daylight. Points and directions are in the robot's frame, which the lamps are fixed to.
///
/// Source: Jaffe 1990 (inverse square, attenuation on both ways, single scattering). The beam is half as
/// bright at the half angle, as data sheets have it.
namespace fathom {

/// On a surface that faces the lamp, red green blue: S exp(-a d) / d².
template <class T>
Vector3<T> lampIrradiance(const LampSheet& lamp, const Vector3<T>& point_robot,
                          const Vector3<T>& attenuation_per_m) {
  using std::exp, std::exp2;
  const Vector3<T> way = point_robot - lamp.T_robot_lamp.position.template cast<T>();
  const T distance_m = way.norm();
  const T off_axis = 1.0 - lamp.T_robot_lamp.rotation.col(0).template cast<T>().dot(way) / distance_m;
  const T beam = exp2(-off_axis / (1 - std::cos(lamp.half_angle_rad))) / (distance_m * distance_m);
  Vector3<T> irradiance;
  for (int c = 0; c < 3; ++c) irradiance[c] = beam * exp(-attenuation_per_m[c] * distance_m);
  return irradiance;
}

/// On a surface with this normal, of all lamps. Nothing casts a shadow.
template <class T>
Vector3<T> lampsOnSurface(const std::vector<LampSheet>& lamps, const Vector3<T>& point_robot,
                          const Vector3<T>& normal_robot, const Vector3<T>& attenuation_per_m) {
  Vector3<T> sum = Vector3<T>::Zero();
  for (const LampSheet& lamp : lamps) {
    const Vector3<T> to_lamp = lamp.T_robot_lamp.position.template cast<T>() - point_robot;
    const T cosine = normal_robot.dot(to_lamp) / to_lamp.norm();
    if (cosine > T(0)) sum += cosine * lampIrradiance(lamp, point_robot, attenuation_per_m);
  }
  return sum;
}

/// Light that is scattered by an angle of this cosine, over what it would be if scattering were the same in
/// all directions (Henyey & Greenstein 1941).
template <class T>
T henyeyGreenstein(const T& asymmetry, const T& cosine) {
  using std::sqrt;
  const T square = 1.0 + asymmetry * asymmetry - 2.0 * asymmetry * cosine;
  return (1.0 - asymmetry * asymmetry) / (square * sqrt(square));
}

/// A line of sight in water that scatters of the lamps' light as much as of daylight, which makes the veil:
/// attenuation times veil is what it gains a metre in daylight. But by a phase function of its own.
template <class T>
struct LitSight {
  Vector3<T> camera_robot, direction_robot;  ///< unit length
  T z_per_range;                             ///< attenuation is by z, see predictLight()
  WaterColumn<T> water;
  Vector3<T> ambient;
  T asymmetry = T(0);  ///< see SceneLight

  /// Radiance that the lamps add a metre at range s_m, as it arrives at the camera.
  Vector3<T> gain(const std::vector<LampSheet>& lamps, const T& s_m) const {
    using std::exp;
    const Vector3<T> point_robot = camera_robot + s_m * direction_robot;
    Vector3<T> irradiance = Vector3<T>::Zero();
    for (const LampSheet& lamp : lamps) {
      const Vector3<T> way = point_robot - lamp.T_robot_lamp.position.template cast<T>();
      const T cosine = -direction_robot.dot(way) / way.norm();
      irradiance +=
          henyeyGreenstein(asymmetry, cosine) * lampIrradiance(lamp, point_robot, water.attenuation_per_m);
    }
    Vector3<T> radiance;
    for (int c = 0; c < 3; ++c) {
      const T a = water.attenuation_per_m[c], daylight = ambient[c] > T(kDusk) ? ambient[c] : T(kDusk);
      radiance[c] = irradiance[c] * a * water.veil[c] / daylight * exp(-a * s_m * z_per_range);
    }
    return radiance;
  }

  static constexpr double kDusk = 0.01;  ///< darker daylight tells nothing of how the water scatters
};

/// Ranges from 0 to infinity as shares w from 0 to 1: s = w / (1 - w) metres. Lamps' light gathers near by.
template <class T>
T rangeShare(const T& range_m) {
  return range_m / (range_m + T(1));
}

/// Radiance that the lamps add along a line of sight up to a range: by Gauss' quadrature over w.
template <class T>
Vector3<T> lampsInWater(const std::vector<LampSheet>& lamps, const LitSight<T>& sight, const T& range_m) {
  const T end = rangeShare(range_m);
  Vector3<T> sum = Vector3<T>::Zero();
  for (const auto& [abscissa, weight] : GaussLegendre20::kPoints)
    for (const double side : {-1.0, 1.0}) {
      const T w = 0.5 * end * (1.0 + side * abscissa);
      const T s_m = w / (1.0 - w);
      sum += (0.5 * end * weight / ((1.0 - w) * (1.0 - w))) * sight.gain(lamps, s_m);
    }
  return sum;
}

}  // namespace fathom
