#include "port.h"

#include <cmath>
#include <utility>

namespace fathom::sealed {
namespace {

constexpr double kAir = 1.0, kGlass = 1.5, kWater = 1.34;
constexpr double kUsualDome_m = 0.075, kUsualDomeGlass_m = 0.005;
constexpr double kBeforeCamera_m = 0.05;
constexpr double kWidest = 0.9;  // tangent off the axis: farther out the distortion's polynomial folds back
constexpr int kPortSteps = 100;
constexpr double kPortConverged = 1e-13;

}  // namespace

Vector3d refracted(const Vector3d& direction, const Vector3d& normal, double n1_over_n2) {
  const double cosine = direction.dot(normal);
  const double refracted_cosine = std::sqrt(1 - n1_over_n2 * n1_over_n2 * (1 - cosine * cosine));
  return n1_over_n2 * direction + (refracted_cosine - n1_over_n2 * cosine) * normal;
}

TrueCamera::TrueCamera(const Camera& nominal, const SealedCase& sealed, double t_s)
    : camera_(nominal), has_port_(sealed.find("flat-port-refraction", t_s) != nullptr) {
  const auto number = [&](const char* id, const char* parameter) {
    return sealed.number(id, parameter, t_s);
  };
  const double focal_scale = 1 + number("focal-scale", "scale_error");
  camera_.fx_px *= focal_scale;
  camera_.fy_px *= focal_scale;
  camera_.k1 += number("lens-distortion", "k1_error");
  camera_.k2 += number("lens-distortion", "k2_error");
  camera_.p1 += number("lens-distortion", "p1_error");
  camera_.p2 += number("lens-distortion", "p2_error");
  distance_m_ = number("flat-port-refraction", "distance_m");
  glass_m_ = number("flat-port-refraction", "glass_m");
  intrinsics_index_ = kWater / (1 + number("flat-port-refraction", "index_error"));
  const Vector3d tilt_deg(number("flat-port-refraction", "tilt_deg"),
                          number("flat-port-refraction", "tilt_y_deg"), 0);
  normal_ = expSO3<double>(tilt_deg * radians(1.0)).col(2);
  has_dome_ = sealed.find("dome-port", t_s) != nullptr;
  dome_centre_ = -sealed.vector("dome-port", "offset_m", t_s);
  dome_outer_m_ = number("dome-port", "radius_m") > 0 ? number("dome-port", "radius_m") : kUsualDome_m;
  const double glass_m = number("dome-port", "thickness_m");
  dome_inner_m_ = dome_outer_m_ - (glass_m > 0 ? glass_m : kUsualDomeGlass_m);
}

/// Brown 1966, in OpenCV's notation.
Vector2d TrueCamera::distorted(const Vector2d& ideal) const {
  const double x = ideal.x(), y = ideal.y(), r2 = ideal.squaredNorm();
  const double radial = 1 + camera_.k1 * r2 + camera_.k2 * r2 * r2 + camera_.k3 * r2 * r2 * r2;
  return {x * radial + 2 * camera_.p1 * x * y + camera_.p2 * (r2 + 2 * x * x),
          y * radial + camera_.p1 * (r2 + 2 * y * y) + 2 * camera_.p2 * x * y};
}

Vector2d TrueCamera::pixelAt(const Vector2d& ideal) const {
  const Vector2d image = distorted(ideal);
  return {camera_.fx_px * image.x() + camera_.cx_px, camera_.fy_px * image.y() + camera_.cy_px};
}

/// Fixed point: distortion is a small part of the whole.
Vector2d TrueCamera::idealAt(const Vector2d& pixel) const {
  const Vector2d image((pixel.x() - camera_.cx_px) / camera_.fx_px,
                       (pixel.y() - camera_.cy_px) / camera_.fy_px);
  Vector2d ideal = image;
  for (int i = 0; i < kPortSteps; ++i) {
    const Vector2d missing = image - distorted(ideal);
    ideal += missing;
    if (missing.norm() < kPortConverged) break;
  }
  return ideal;
}

/// Intrinsics contain the bending at a window right at the camera, from water of the index that they were
/// calibrated in: undone first, what is left in air is the lens's own line of sight. That passes the gap, the
/// glass and the water, bent at each surface (layers with one normal: Agrawal et al. 2012, sec. 3).
Ray TrueCamera::rayAlong(const Vector2d& ideal) const {
  const Vector3d calibrated = ideal.homogeneous().normalized();
  if (has_dome_) return throughDome(calibrated);
  if (!has_port_) return {Vector3d::Zero(), calibrated};
  const Vector3d in_air = refracted(calibrated, normal_, intrinsics_index_ / kAir);
  const Vector3d in_glass = refracted(in_air, normal_, kAir / kGlass);
  const Vector3d in_water = refracted(in_glass, normal_, kGlass / kWater);
  const Vector3d leaves =
      in_air * (distance_m_ / in_air.dot(normal_)) + in_glass * (glass_m_ / in_glass.dot(normal_));
  return {leaves, in_water.normalized()};
}

/// The light's own way backwards: to the far side of each sphere about the dome's centre. On its plane with
/// that centre, what a sphere's radius makes of the angle at it is the sine by index (Bouguer's invariant).
Ray TrueCamera::throughDome(const Vector3d& direction) const {
  Ray ray{Vector3d::Zero(), direction};
  double index = kAir;
  for (const auto& [radius_m, next] : {std::pair{dome_inner_m_, kGlass}, std::pair{dome_outer_m_, kWater}}) {
    const Vector3d nearest =
        ray.origin - dome_centre_ - ray.direction * (ray.origin - dome_centre_).dot(ray.direction);
    const double within_m = std::sqrt(radius_m * radius_m - nearest.squaredNorm());
    const Vector3d hit = dome_centre_ + nearest + within_m * ray.direction;
    ray = {hit, refracted(ray.direction, (hit - dome_centre_).normalized(), index / next)};
    index = next;
  }
  return ray;
}

/// Moves the line of sight by what it misses the point by, as an angle, until it meets it.
std::optional<Vector2d> TrueCamera::pixelOf(const Vector3d& point_camera) const {
  if (point_camera.z() < kBeforeCamera_m) return std::nullopt;
  Vector2d ideal = point_camera.head<2>() / point_camera.z();
  for (int i = 0; (has_port_ || has_dome_) && i < kPortSteps; ++i) {
    const Vector3d missing = point_camera - rayAlong(ideal).atHeight(point_camera.z());
    const Vector2d step = missing.head<2>() / point_camera.z();
    ideal += step;
    if (!(step.norm() > kPortConverged)) break;
  }
  if (!(ideal.norm() < kWidest)) return std::nullopt;
  return pixelAt(ideal);
}

}  // namespace fathom::sealed
