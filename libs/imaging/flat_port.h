#pragma once

#include <array>
#include <cmath>

#include "core/scalar.h"
#include "effects/stages.h"

/// A camera behind a flat port: air | glass | water in parallel layers, n sin(theta) the same in each, so
/// a line of sight stays in one plane with the port's normal through the camera's centre (Treibitz et al.
/// 2012; Agrawal et al. 2012).
///
/// The nominal intrinsics contain some of the bending. With index_error = 0 they are those of a calibration
/// under water: a port without thickness at the camera's very centre is then no port at all. With
/// index_error = 1.34/1 - 1 they are those of a calibration in air.
///
/// A window that is some way off (`window_m`), as an aquarium's before a camera in air, is reached through
/// what the intrinsics are for: without index_error it does nothing.
///
/// A camera in air that looks through a tank sees a slab of water with air on both sides. Angles depend on
/// ratios of indices alone, so the slab is one more layer, 1.34 times as dense as what is nominal.
namespace fathom {

inline constexpr double kGlassIndex = 1.5;                       ///< acrylic 1.49, float glass 1.52
inline constexpr double kSlabIndex = kWaterIndex * kWaterIndex;  ///< where what lies beyond it is kWaterIndex

namespace detail {

template <class T>
struct PortLayer {
  T index, thickness_m;  ///< along the normal
};

/// What lies before the water, from the camera outwards.
template <class T, class P>
std::array<PortLayer<T>, 4> layersBeforeWater(const FlatPort<P>& port) {
  return {{{kWaterIndex / (1.0 + T(port.index_error)), T(port.window_m)},
           {T(1), T(port.distance_m)},
           {T(kGlassIndex), T(port.glass_m)},
           {T(kSlabIndex), T(port.slab_m)}}};
}

/// The layers between the camera's centre and a point, and the light's way through them. The unknown is
/// `slope`: tan(theta_air) over the point's lateral distance, which stays smooth on the normal itself.
template <class T>
struct PortCrossing {
  std::array<PortLayer<T>, 5> layers;  ///< the last one is the water
  T lateral_squared;                   ///< of the point, m²
  T calibration_per_m;

  PortCrossing<double> plain() const {
    PortCrossing<double> values{{}, valueOf(lateral_squared), valueOf(calibration_per_m)};
    for (std::size_t i = 0; i < layers.size(); ++i)
      values.layers[i] = {valueOf(layers[i].index), valueOf(layers[i].thickness_m)};
    return values;
  }

  /// tan(theta) over the lateral distance, in a medium of index n: tan(theta_n) = tan(theta_air) /
  /// sqrt(n² + (n² - 1) tan²(theta_air)).
  T slopeIn(const T& index, const T& slope) const {
    using std::sqrt;
    const T n2 = index * index;
    return slope / sqrt(n2 + (n2 - 1.0) * slope * slope * lateral_squared);
  }
  /// d slopeIn / d slope = n² (n² + (n² - 1) tan²(theta_air))^-3/2.
  T slopeInBySlope(const T& index, const T& slope) const {
    using std::pow;
    const T n2 = index * index;
    return n2 * pow(n2 + (n2 - 1.0) * slope * slope * lateral_squared, -1.5);
  }
  /// Where the light of this slope ends, as a share of the lateral distance, minus 1: zero for the point.
  T miss(const T& slope) const {
    T reached(0);
    for (const PortLayer<T>& layer : layers) reached += slopeIn(layer.index, slope) * layer.thickness_m;
    return reached - 1.0;
  }
  T missBySlope(const T& slope) const {
    T sum(0);
    for (const PortLayer<T>& layer : layers) sum += slopeInBySlope(layer.index, slope) * layer.thickness_m;
    return sum;
  }
  /// What the light's slope is taken for by the intrinsics.
  T apparent(const T& slope) const {
    return asCalibrated([&](const T& index) { return slopeIn(index, slope); });
  }
  T apparentBySlope(const T& slope) const {
    return asCalibrated([&](const T& index) { return slopeInBySlope(index, slope); });
  }
  /// In the medium that the intrinsics contain and, where they were found through this port at a range of
  /// 1 / calibration_per_m, what the light is off sideways there. A slab of water is not the camera's own.
  template <class SlopeIn>
  T asCalibrated(const SlopeIn& slope_in) const {
    const T nominal = slope_in(layers[0].index);
    const auto aside_m = [&](const PortLayer<T>& own) {
      return T((slope_in(own.index) - nominal) * own.thickness_m);
    };
    return nominal + calibration_per_m * (aside_m(layers[1]) + aside_m(layers[2]));
  }
};

/// Newton's method from 0. miss() is concave and grows, so it comes up to the root and never beyond. A point
/// that no light reaches the camera from (beyond the critical angle) is seen along the port.
double solveSlope(const PortCrossing<double>& port);

/// What misses by more, as a share of the distance, is no root.
inline constexpr double kMissed = 1e-6;

/// One Newton step in T, which gives a root its derivatives (implicit function). What is no root, beyond the
/// critical angle, has none.
template <class T>
T withDerivatives(double root, const T& miss, double by_root) {
  return std::abs(valueOf(miss)) > kMissed ? T(root) : T(root) - miss / by_root;
}

template <class T, class P>
Vector3<T> normalOf(const FlatPort<P>& port) {
  return expSO3<T>(Vector3<T>(T(port.tilt_x_rad), T(port.tilt_y_rad), T(0))).col(2);
}

/// To a point with so much water between it and the port.
template <class T, class P>
PortCrossing<T> crossingOf(const FlatPort<P>& port, const T& lateral_squared, const T& water_m) {
  const auto before = layersBeforeWater<T>(port);
  return {{before[0], before[1], before[2], before[3], {T(kWaterIndex), water_m}},
          lateral_squared,
          T(port.calibration_per_m)};
}

/// Newton's method for the light that is taken for this slope, from where a calibration far away has it. What
/// no light is taken for is light along the port.
double solveApparent(const PortCrossing<double>& port, double apparent);

}  // namespace detail

/// The direction (of any length, camera frame) in which a camera with the nominal intrinsics would have to
/// look straight at a point to see it where it appears through the port. Parameters of the port may be
/// constants among the point's Jets.
template <class T, class P>
Vector3<T> apparentDirection(const FlatPort<P>& port, const Vector3<T>& point_camera) {
  const Vector3<T> normal = detail::normalOf<T>(port);
  const T height = normal.dot(point_camera);
  const Vector3<T> lateral = point_camera - height * normal;

  constexpr double kThinnestWater_m = 1e-3;  // what touches the port
  T water_m = height;
  for (const auto& layer : detail::layersBeforeWater<T>(port)) water_m -= layer.thickness_m;
  if (water_m < kThinnestWater_m) water_m = T(kThinnestWater_m);
  const detail::PortCrossing<T> crossing = detail::crossingOf<T>(port, T(lateral.squaredNorm()), water_m);
  const detail::PortCrossing<double> plain = crossing.plain();
  const double root = detail::solveSlope(plain);
  const T slope = detail::withDerivatives(root, crossing.miss(T(root)), plain.missBySlope(root));

  return normal + crossing.apparent(slope) * lateral;
}

template <class T>
struct SightLine {
  Vector3<T> origin, direction;  ///< direction of unit length
};

/// The inverse: where the light comes from, behind the port, that appears in a direction (of any length).
template <class T, class P>
SightLine<T> lightBehind(const FlatPort<P>& port, const Vector3<T>& apparent) {
  const Vector3<T> normal = detail::normalOf<T>(port);
  const Vector3<T> lateral = apparent / apparent.dot(normal) - normal;
  const detail::PortCrossing<T> crossing = detail::crossingOf<T>(port, T(lateral.squaredNorm()), T(0));
  const detail::PortCrossing<double> plain = crossing.plain();
  const double root = detail::solveApparent(plain, 1.0);
  const T slope =
      detail::withDerivatives(root, T(crossing.apparent(T(root)) - 1.0), plain.apparentBySlope(root));

  SightLine<T> line{Vector3<T>::Zero(), normal + crossing.slopeIn(T(kWaterIndex), slope) * lateral};
  line.direction.normalize();
  for (const auto& layer : detail::layersBeforeWater<T>(port))
    line.origin += (normal + crossing.slopeIn(layer.index, slope) * lateral) * layer.thickness_m;
  return line;
}

// Without derivatives: compiled once, in camera_geometry.cpp.
extern template Vector3<double> apparentDirection(const FlatPort<double>&, const Vector3<double>&);
extern template SightLine<double> lightBehind(const FlatPort<double>&, const Vector3<double>&);

}  // namespace fathom
