#pragma once

#include <cmath>

#include "core/scalar.h"
#include "effects/stages.h"
#include "imaging/flat_port.h"

/// A camera in air above a flat surface of water: two of the layers of flat_port.h, air and water, whose
/// common normal is the surface's in the world, not the camera's own. n sin(theta) is the same in both. What
/// is above the surface is seen straight, and so is all by a camera that is below it.
///
/// No water is no surface, and what there is has to come from nothing smoothly, for fits begin there. But at
/// a depth of zero a surface would pass through the panel, and half of it be below. So what is not at the
/// height of the panel's origin gets its own depth only as there comes to be kFullDepth_m of water over
/// that; from there on all is as it is.
namespace fathom {

inline constexpr double kFullDepth_m = 0.05;

/// The surface in the frame of a camera there.
template <class T>
struct SurfaceBelow {
  bool present = false;                          ///< false: straight lines of sight
  Vector3<T> down_camera = Vector3<T>::UnitZ();  ///< its normal, from air into water
  T camera_m = T(0);  ///< along that, from the camera down to where the map has the first panel's origin
  T water_m = T(0);   ///< likewise, of water above that
  T deepened = T(1);  ///< share of its own depth that what is elsewhere has, see kFullDepth_m
  T index = T(kWaterIndex);

  /// How much water is above what is so far below the camera, along the normal; negative: it is in air.
  T waterAbove(const T& below_camera_m) const { return water_m + deepened * (below_camera_m - camera_m); }

  /// As the same camera has it once it has moved on along `way_camera` and turned.
  SurfaceBelow seenAfter(const Matrix3<T>& R_camera_then, const Vector3<T>& way_camera) const {
    SurfaceBelow then = *this;
    then.down_camera = R_camera_then.transpose() * down_camera;
    then.camera_m -= down_camera.dot(way_camera);
    return then;
  }
  template <class U>
  SurfaceBelow<U> cast() const {
    return {present, down_camera.template cast<U>(), U(camera_m), U(water_m), U(deepened), U(index)};
  }
  /// Without derivatives.
  SurfaceBelow<double> values() const {
    return {present,           {valueOf(down_camera.x()), valueOf(down_camera.y()), valueOf(down_camera.z())},
            valueOf(camera_m), valueOf(water_m),
            valueOf(deepened), valueOf(index)};
  }
};

/// The surface below a camera that is `from_panel_odom` away from where the map has the first panel's origin.
template <class T>
SurfaceBelow<T> seenFrom(const WaterSurface<T>& surface, const Matrix3<T>& R_odom_camera,
                         const Vector3<T>& from_panel_odom) {
  using std::exp;
  const Vector3<T> up_odom = expSO3<T>(Vector3<T>(surface.tilt_x_rad, surface.tilt_y_rad, T(0))).col(2);
  SurfaceBelow<T> below{true,
                        -(R_odom_camera.transpose() * up_odom),
                        up_odom.dot(from_panel_odom),
                        surface.water_m * up_odom.z(),
                        T(1),
                        T(kWaterIndex * exp(surface.log_index))};
  if (below.index < 1.0) below.index = T(1);  // a fit may try what is thinner than air
  if (surface.water_m < kFullDepth_m) {
    const T share = surface.water_m > 0.0 ? T(surface.water_m / kFullDepth_m) : T(0);
    below.deepened = share * share * (3.0 - 2.0 * share);
  }
  return below;
}

/// Where a pinhole above the water would see a point straight ahead (camera frame): at its height, aside.
template <class T>
Vector3<T> apparentPoint(const SurfaceBelow<T>& surface, const Vector3<T>& point_camera) {
  const T below_m = surface.down_camera.dot(point_camera);
  const T water_m = surface.waterAbove(below_m), air_m = below_m - water_m;
  if (water_m < 0.0 || !(air_m > 0.0)) return point_camera;
  const Vector3<T> lateral = point_camera - below_m * surface.down_camera;
  const detail::PortLayer<T> none{T(1), T(0)};
  const detail::PortCrossing<T> crossing{
      {{{T(1), air_m}, none, none, none, {surface.index, water_m}}}, T(lateral.squaredNorm()), T(0)};
  const detail::PortCrossing<double> plain = crossing.plain();
  const double root = detail::solveSlope(plain);
  const T slope = detail::withDerivatives(root, crossing.miss(T(root)), plain.missBySlope(root));
  return below_m * (surface.down_camera + slope * lateral);
}

/// The inverse: where what is seen along a line in air lies below the surface. The line itself, where it does
/// not come to water.
template <class T>
SightLine<T> lightBelow(const SurfaceBelow<T>& surface, const SightLine<T>& line) {
  using std::sqrt;
  const Vector3<T>& down = surface.down_camera;
  const T cosine = down.dot(line.direction), origin_m = down.dot(line.origin);
  if (!(surface.water_m > 0.0 && surface.waterAbove(origin_m) < 0.0 && cosine > 0.0)) return line;
  // Aside by metre of depth, in air and in water.
  const Vector3<T> in_air = line.direction / cosine - down;
  const T n2 = surface.index * surface.index;
  const Vector3<T> in_water = in_air / sqrt(n2 + (n2 - 1.0) * in_air.squaredNorm());
  const T air_m = surface.camera_m - surface.water_m / surface.deepened - origin_m;
  SightLine<T> light{line.origin + air_m * (down + in_air),
                     down + in_air + surface.deepened * (in_water - in_air)};
  light.direction.normalize();
  return light;
}

}  // namespace fathom
