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

inline constexpr double kGlassIndex = 1.5;   ///< acrylic 1.49, float glass 1.52
inline constexpr double kWaterIndex = 1.34;  ///< sea water in green light (Quan & Fry 1995); fresh 1.334
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

  /// tan(theta) over the lateral distance, in a medium of index n: tan(theta_n) = tan(theta_air) /
  /// sqrt(n² + (n² - 1) tan²(theta_air)).
  T slopeIn(const T& index, const T& slope) const {
    using std::sqrt;
    const T n2 = index * index;
    return slope / sqrt(n2 + (n2 - 1.0) * slope * slope * lateral_squared);
  }
  /// Where the light of this slope ends, as a share of the lateral distance, minus 1: zero for the point.
  T miss(const T& slope) const {
    T reached(0);
    for (const PortLayer<T>& layer : layers) reached += slopeIn(layer.index, slope) * layer.thickness_m;
    return reached - 1.0;
  }
};

/// d miss / d slope: d/ds s (n² + (n² - 1) s² q)^-1/2 = n² (…)^-3/2.
inline double missBySlope(const PortCrossing<double>& port, double slope) {
  double sum = 0;
  for (const PortLayer<double>& layer : port.layers) {
    const double n2 = layer.index * layer.index;
    sum += n2 / std::pow(n2 + (n2 - 1) * slope * slope * port.lateral_squared, 1.5) * layer.thickness_m;
  }
  return sum;
}

/// Newton's method from 0. miss() is concave and grows, so it comes up to the root and never beyond. A point
/// that no light reaches the camera from (beyond the critical angle) is seen along the port.
double solveSlope(const PortCrossing<double>& port);

}  // namespace detail

/// The direction (of any length, camera frame) in which a camera with the nominal intrinsics would have to
/// look straight at a point to see it where it appears through the port. Parameters of the port may be
/// constants among the point's Jets. Differentiable by the implicit function: solved in double, then one
/// Newton step in T.
template <class T, class P>
Vector3<T> apparentDirection(const FlatPort<P>& port, const Vector3<T>& point_camera) {
  const Vector3<T> tilt(T(port.tilt_x_rad), T(port.tilt_y_rad), T(0));
  const Vector3<T> normal = expSO3<T>(tilt).col(2);
  const T height = normal.dot(point_camera);
  const Vector3<T> lateral = point_camera - height * normal;

  constexpr double kThinnestWater_m = 1e-3;  // what touches the port
  const auto before = detail::layersBeforeWater<T>(port);
  T water_m = height;
  for (const auto& layer : before) water_m -= layer.thickness_m;
  if (water_m < kThinnestWater_m) water_m = T(kThinnestWater_m);
  const detail::PortCrossing<T> crossing{
      {before[0], before[1], before[2], before[3], {T(kWaterIndex), water_m}}, lateral.squaredNorm()};
  detail::PortCrossing<double> plain{{}, valueOf(crossing.lateral_squared)};
  for (std::size_t i = 0; i < plain.layers.size(); ++i)
    plain.layers[i] = {valueOf(crossing.layers[i].index), valueOf(crossing.layers[i].thickness_m)};
  const double root = detail::solveSlope(plain);
  const T slope = T(root) - crossing.miss(T(root)) / detail::missBySlope(plain, root);

  return normal + crossing.slopeIn(before[0].index, slope) * lateral;
}

template <class T>
struct SightLine {
  Vector3<T> origin, direction;  ///< direction of unit length
};

/// The inverse: where the light comes from, behind the port, that appears in a direction (of any length).
template <class T, class P>
SightLine<T> lightBehind(const FlatPort<P>& port, const Vector3<T>& apparent) {
  using std::sqrt;
  const Vector3<T> normal = expSO3<T>(Vector3<T>(T(port.tilt_x_rad), T(port.tilt_y_rad), T(0))).col(2);
  const Vector3<T> sight = apparent.normalized();
  const auto before = detail::layersBeforeWater<T>(port);
  // n sin(theta), the same in each layer, along the port.
  const Vector3<T> along = before[0].index * (sight - sight.dot(normal) * normal);
  const auto direction = [&](const T& index) {
    const Vector3<T> lateral = along / index;
    return Vector3<T>(lateral + sqrt(1.0 - lateral.squaredNorm()) * normal);
  };
  SightLine<T> line{Vector3<T>::Zero(), direction(T(kWaterIndex))};
  for (const auto& layer : before) {
    const Vector3<T> d = direction(layer.index);
    line.origin += d * (layer.thickness_m / d.dot(normal));
  }
  return line;
}

// Without derivatives: compiled once, in camera_geometry.cpp.
extern template Vector3<double> apparentDirection(const FlatPort<double>&, const Vector3<double>&);
extern template SightLine<double> lightBehind(const FlatPort<double>&, const Vector3<double>&);

}  // namespace fathom
