#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "core/scalar.h"
#include "effects/stages.h"
#include "imaging/flat_port.h"

/// A camera behind a dome port: air | glass | water between concentric spheres. Light is bent at each of them
/// by Snell's law about the sphere's normal there (She, Nakath, Song & Koeser 2022). Where the
/// camera's centre is the dome's, all light comes along normals: it is no port at all, and the nominal
/// intrinsics, those of a calibration in air, hold.
namespace fathom {

namespace detail {

/// Snell's law for vectors: a unit direction from index n1 into n2 through a surface whose unit normal points
/// along with it (Glassner 1989, ch. 4). Along the surface where nothing passes.
template <class T>
Vector3<T> refracted(const Vector3<T>& direction, const Vector3<T>& normal, double n1_over_n2) {
  using std::sqrt;
  const T cosine = direction.dot(normal);
  const T square = 1.0 - n1_over_n2 * n1_over_n2 * (1.0 - cosine * cosine);
  const T refracted_cosine = square > 0 ? T(sqrt(square)) : T(0);
  return n1_over_n2 * direction + (refracted_cosine - n1_over_n2 * cosine) * normal;
}

/// Where a line from inside a sphere leaves it.
template <class T>
Vector3<T> leaves(const SightLine<T>& line, const Vector3<T>& centre, const T& radius_m) {
  using std::sqrt;
  const Vector3<T> out = line.origin - centre;
  const T half = out.dot(line.direction);
  return line.origin + (sqrt(half * half - out.squaredNorm() + radius_m * radius_m) - half) * line.direction;
}

/// Of a dome, so much of its inner radius at most may lie between its centre and the camera's, and so much of
/// its outer radius at most is glass: a fit may try what no camera fits into, or a ball of glass.
inline constexpr double kFarthestInDome = 0.95, kThickest = 0.5;

}  // namespace detail

/// Where the light comes from, outside the dome, that appears in a direction (of any length, camera frame).
template <class T, class P>
SightLine<T> lightBehind(const DomePort<P>& dome, const Vector3<T>& apparent) {
  using std::exp;
  const T outer_m = T(kUsualDome_m) * exp(T(dome.log_radius));
  T glass_m(dome.glass_m);
  if (glass_m > detail::kThickest * outer_m) glass_m = T(detail::kThickest * outer_m);
  T inner_m = outer_m - glass_m;
  const Vector3<T> centre = dome.centre_m.template cast<T>();
  const double least_m = centre.squaredNorm() > 0 ? valueOf(centre.norm()) / detail::kFarthestInDome : 0.0;
  if (inner_m < least_m) inner_m = T(least_m);
  SightLine<T> line{Vector3<T>::Zero(), apparent.normalized()};
  const auto passInto = [&](double index, double next_index, const T& radius_m) {
    line.origin = detail::leaves(line, centre, radius_m);
    const Vector3<T> normal = (line.origin - centre) / radius_m;
    line.direction = detail::refracted(line.direction, normal, index / next_index);
  };
  passInto(1, kGlassIndex, inner_m);
  passInto(kGlassIndex, kWaterIndex, T(inner_m + glass_m));
  line.direction.normalize();
  return line;
}

namespace detail {

/// By how much the light that appears at (x, y, 1) misses a point, per metre of its distance along z.
template <class T, class P>
Vector2<T> missOf(const DomePort<P>& dome, const Vector2<T>& apparent, const Vector3<T>& point_camera) {
  const SightLine<T> light = lightBehind(dome, Vector3<T>(apparent.x(), apparent.y(), T(1)));
  const Vector3<T> to = point_camera - light.origin;
  const T along = to.z() / light.direction.z();
  return (to - along * light.direction).template head<2>() / point_camera.z();
}

struct Apparent {
  Vector2d direction;                                      ///< (x, y, 1)
  Eigen::Matrix2d miss_by = -Eigen::Matrix2d::Identity();  ///< derivative of missOf() there
};
/// Newton's method from straight ahead to the point, by steps that are not too long. A point that no light
/// reaches the camera from is seen far aside.
Apparent solveApparent(const DomePort<double>& dome, const Vector3d& point_camera);

template <class P>
DomePort<double> plain(const DomePort<P>& dome) {
  return {dome.present,
          {valueOf(dome.centre_m.x()), valueOf(dome.centre_m.y()), valueOf(dome.centre_m.z())},
          valueOf(dome.log_radius),
          valueOf(dome.glass_m)};
}

}  // namespace detail

/// The direction in which a camera with the nominal intrinsics would have to look straight at a point before
/// it (z > 0) to see it where it appears through the dome. Solved in double, then one Newton step in T, which
/// gives it its derivatives.
template <class T, class P>
Vector3<T> apparentDirection(const DomePort<P>& dome, const Vector3<T>& point_camera) {
  const Vector3d point(valueOf(point_camera.x()), valueOf(point_camera.y()), valueOf(point_camera.z()));
  const detail::Apparent root = detail::solveApparent(detail::plain(dome), point);
  const Vector2<T> at = root.direction.template cast<T>();
  const Vector2<T> miss = detail::missOf(dome, at, point_camera);
  // What is no root has no derivatives.
  if (!(std::hypot(valueOf(miss.x()), valueOf(miss.y())) < detail::kMissed)) return {at.x(), at.y(), T(1)};
  const Vector2<T> found = at - root.miss_by.inverse().template cast<T>() * miss;
  return {found.x(), found.y(), T(1)};
}

}  // namespace fathom
