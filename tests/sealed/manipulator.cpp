#include "manipulator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "streams.h"

namespace fathom::sealed {
namespace {

constexpr double kPeriod_s = 20;
constexpr double kRadius_m = 0.03, kAlbedo = 0.06;
constexpr double kFar_m = 20;
const Vector3d kBase_robot(0.45, -0.35, -0.35), kTip_robot(1.1, 0, 0);
constexpr double kSwayY_m = 0.12, kSwayZ_m = 0.1, kSwayY_rad_s = 0.5, kSwayZ_rad_s = 0.37;

/// How near a line of sight comes to the arm's axis, and how far along the line.
struct Passing {
  double distance_m, along_m;
};

/// Of two segments, from the camera to a point and along the arm (Ericson 2005, sec. 5.1.9).
Passing passingOf(const Arm& arm, const Vector3d& origin, const Vector3d& point) {
  const Vector3d sight = point - origin, axis = arm.tip_camera - arm.base_camera,
                 between = origin - arm.base_camera;
  const double a = sight.squaredNorm(), e = axis.squaredNorm(), b = sight.dot(axis);
  const double c = sight.dot(between), f = axis.dot(between);
  const double across = a * e - b * b;
  double s = across > 0 ? std::clamp((b * f - c * e) / across, 0.0, 1.0) : 0.0;
  const double t = std::clamp((b * s + f) / e, 0.0, 1.0);
  s = std::clamp((b * t - c) / a, 0.0, 1.0);
  const Vector3d apart = between + s * sight - t * axis;
  return {apart.norm(), s * std::sqrt(a)};
}

/// Round: darker towards its rim.
cv::Vec3f colourOf(const View& view, double off_axis, double along_m) {
  const double facing = std::sqrt(std::max(0.0, 1 - off_axis * off_axis));
  const Array3d seen =
      kAlbedo * (0.3 + 0.7 * facing) * view.water.daylight * view.water.transmission(along_m) +
      view.water.veilBefore(along_m);
  return {static_cast<float>(seen.x()), static_cast<float>(seen.y()), static_cast<float>(seen.z())};
}

}  // namespace

bool Arm::hides(const Vector3d& point_camera) const {
  return passingOf(*this, Vector3d::Zero(), point_camera).distance_m < kRadius_m;
}

std::optional<Arm> armAt(const SealedCase& sealed, const Vehicle& vehicle, double stamp_s) {
  Random random = stream(sealed.seed, Stream::arm);
  const double turns = stamp_s / kPeriod_s + random.uniform();
  const double y_rad = random.uniform(0, 2 * std::numbers::pi),
               z_rad = random.uniform(0, 2 * std::numbers::pi);
  if (turns - std::floor(turns) >= sealed.outsideSize("manipulator")) return std::nullopt;
  const Vector3d sway(0, kSwayY_m * std::sin(kSwayY_rad_s * stamp_s + y_rad),
                      kSwayZ_m * std::sin(kSwayZ_rad_s * stamp_s + z_rad));
  const Pose T_camera_robot = vehicle.camera.pose.pose().inverse();
  return Arm{T_camera_robot * kBase_robot, T_camera_robot * Vector3d(kTip_robot + sway)};
}

void addArm(const View& view, const Vehicle& vehicle, cv::Mat3f& light) {
  const auto arm = armAt(view.sealed, vehicle, view.stamp_s);
  if (!arm) return;
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column) {
      const Ray ray = view.sight.at({column, row});
      const auto [distance_m, along_m] = passingOf(*arm, ray.origin, ray.atHeight(kFar_m));
      const double pixel_m = along_m / view.camera.fx_px;
      const double covered = std::clamp((kRadius_m - distance_m) / pixel_m + 0.5, 0.0, 1.0);
      if (covered == 0) continue;
      const auto fraction = static_cast<float>(covered);
      light(row, column) =
          (1 - fraction) * light(row, column) + fraction * colourOf(view, distance_m / kRadius_m, along_m);
    }
}

}  // namespace fathom::sealed
