#include "support/ray_caster.h"

#include <algorithm>
#include <cmath>

namespace fathom::test {

Hit castRay(const Surface& surface, const Vector3d& from_odom, const Vector3d& direction_odom) {
  Hit best;
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    const auto corner = [&](std::size_t i) {
      return Vector3d(surface.vertices[surface.triangles[k][i]].position.cast<double>());
    };
    const Vector3d a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
    const Vector3d p = direction_odom.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0) continue;
    const Vector3d s = from_odom - a, q = s.cross(ab);
    const double u = s.dot(p) / determinant, v = direction_odom.dot(q) / determinant;
    const double range_m = ac.dot(q) / determinant;
    if (u < 0 || v < 0 || u + v > 1 || range_m <= 0 || range_m >= best.range_m) continue;
    best = {range_m, k, Vector3d(1 - u - v, u, v), std::min({1 - u - v, u, v})};
  }
  return best;
}

Hit castRay(const Surface& surface, const CameraModel& camera, const Pose& T_odom_camera,
            const Vector2d& pixel) {
  return castRay(surface, T_odom_camera.position, T_odom_camera.rotation * camera.rayAt(pixel));
}

Vector3d lightOf(const Hit& hit, const Surface& surface, const Lighting& lighting, const Vector3d& from_odom,
                 const Vector3d& direction_odom) {
  Vector3d albedo = Vector3d::Zero(), normal = Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& vertex = surface.vertices[surface.triangles[hit.triangle][i]];
    const double share = hit.shares[static_cast<Eigen::Index>(i)];
    albedo += share * vertex.albedo.cast<double>();
    normal += share * vertex.normal.cast<double>();
  }
  normal.normalize();
  const Vector3d point = from_odom + hit.range_m * direction_odom;
  Vector3d irradiance = lighting.ambient.cast<double>();
  for (const Spot& spot : lighting.spots) {
    const Vector3d beam = point - spot.T_odom_lamp.position;
    const double off_axis_rad = std::atan2(spot.T_odom_lamp.rotation.col(0).cross(beam).norm(),
                                           spot.T_odom_lamp.rotation.col(0).dot(beam));
    if (off_axis_rad > spot.half_angle_rad) continue;
    const double cos_incidence = -beam.normalized().dot(normal);
    if (cos_incidence > 0)
      irradiance += spot.irradiance_1m.cast<double>() * cos_incidence / beam.squaredNorm();
  }
  return albedo.cwiseProduct(irradiance);
}

}  // namespace fathom::test
