#include "viewpoint.h"

#include <cmath>
#include <numbers>

#include "ordinary.h"
#include "recording/samples.h"

namespace fathom::sealed {
namespace {

constexpr double kShakeX_rad_s = 2 * std::numbers::pi * 3.1, kShakeY_rad_s = 2 * std::numbers::pi * 4.7;
constexpr int kRowSteps = 6;  // each brings the row nearer by what the image moves while it is read out

}  // namespace

Viewpoint::Viewpoint(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive)
    : vehicle_(vehicle),
      sealed_(sealed),
      dive_(dive),
      shake_rad_(radians(sealed.outsideSize("mount-shake"))),
      shake_phase_rad_(stream(sealed.seed, Stream::shake).uniform(0, 2 * std::numbers::pi)) {}

Pose Viewpoint::T_odom_camera(double t_s, double stamp_s) const {
  Pose T_robot_camera = vehicle_.camera.pose.pose();
  T_robot_camera.rotation *= sealed_.rotation("camera-misalignment", "rotation_deg", stamp_s);
  if (shake_rad_ != 0)
    T_robot_camera.rotation *=
        expSO3<double>({shake_rad_ * std::sin(kShakeX_rad_s * t_s + shake_phase_rad_),
                        shake_rad_ * std::cos(kShakeY_rad_s * t_s + shake_phase_rad_), 0});
  return dive_.poseAt(t_s) * T_robot_camera;
}

/// By the camera's clock, which drifts and jitters.
double Viewpoint::trueTime_s(double stamp_s) const {
  const double drifted_s = sealed_.trueTime_s(labels::kCamera, stamp_s);
  if (sealed_.ordinary == 0) return drifted_s;
  const double ppm =
      sealed_.ordinary * kOrdinary.camera_clock_ppm * stream(sealed_.seed, Stream::clock).normal();
  const double jitter_s =
      sealed_.ordinary * kOrdinary.stamp_s * streamAt(sealed_.seed, Stream::jitter, stamp_s).normal();
  return drifted_s / (1 + 1e-6 * ppm) + jitter_s;
}

/// The stamp is of the first row (Meingast et al. 2005).
double Viewpoint::rowTime_s(double row_px, double stamp_s) const {
  return trueTime_s(stamp_s) - sealed_.number("camera-latency", "latency_s", stamp_s) +
         sealed_.number("rolling-shutter", "readout_s", stamp_s) * row_px / vehicle_.camera.height_px;
}

std::optional<Vector2d> Viewpoint::pixelOf(const TrueCamera& camera, const Vector3d& point_odom,
                                           double stamp_s) const {
  std::optional<Vector2d> pixel;
  double row_px = vehicle_.camera.height_px / 2.0;
  for (int i = 0; i < kRowSteps; ++i) {
    const Pose T_odom_camera_then = T_odom_camera(rowTime_s(row_px, stamp_s), stamp_s);
    pixel = camera.pixelOf(T_odom_camera_then.inverse() * point_odom);
    if (!pixel || pixel->y() == row_px) break;
    row_px = pixel->y();
  }
  return pixel;
}

}  // namespace fathom::sealed
