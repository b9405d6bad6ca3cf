#pragma once

#include <cstddef>

#include "imaging/camera_geometry.h"
#include "imaging/exposure_time.h"

/// How much softer a marker's edges are in an image than rendered.
namespace fathom {

/// Standard deviation of the smoothing under which edges are compared, see observables/edge_blur.h.
inline constexpr double kEdgeSmoothing_px = 1.5;

/// How much less soft edges look that unsharp masking makes harder by a second moment of `sharpened_px2`: the
/// normal blur that is nearest to it where a step is smoothed by kEdgeSmoothing_px. On an edge by itself that
/// were 0.86 of it, as little as there is (Fourier's integral over both); a marker's cells are a few pixels
/// wide, where rims look like contrast. Fitted, to cells of 4 to 10 px and amounts of up to 1.
template <class T>
T sharpeningSeen_px2(const T& sharpened_px2) {
  return T(0.77 * sharpened_px2 / (1.0 + 0.46 * sharpened_px2));
}

/// By how much a colour of a Bayer pattern that is interpolated bilinearly softens edges: 1/4 px² of green,
/// 1/2 of red and of blue, mean over the pattern; edges are compared in the mean of all three.
inline constexpr double kInterpolated_px2 = (0.25 + 2 * 0.5) / 3;

/// Of one marker in one image: a normal blur's covariance, as xx, xy, yy.
struct MarkerBlur {
  double t_s = 0;  ///< the image's stamp, since the recording's first entry
  std::size_t image = 0, eye = 0, panel = 0;
  int place = 0;                            ///< number of the marker among all panels'
  Vector3d point_panel = Vector3d::Zero();  ///< its centre
  Vector2d pixel = Vector2d::Zero();        ///< where that is seen
  CameraModel camera;
  Pose T_robot_camera;  ///< nominal mounting of this very eye
  Vector3d variance_px2 = Vector3d::Zero();
  Matrix3d covariance_px4 = Matrix3d::Identity();  ///< of that
  double exposure_s = 0;                           ///< the vehicle file's
};

/// Velocity in the image (px/s) of what is at a point in the camera's frame, seen by a camera that moves so,
/// in its own frame. By central differences: the lens bends by less than a thousandth of that over their way.
template <class T>
Vector2<T> imageVelocity(const CameraModel& camera, const Vector3<T>& point_camera,
                         const Vector3<T>& velocity_camera, const Vector3<T>& angular_velocity_camera) {
  constexpr double kStep_s = 1e-3;
  const Vector3<T> way = kStep_s * (-velocity_camera - angular_velocity_camera.cross(point_camera));
  return (camera.project<T>(Vector3<T>(point_camera + way)) -
          camera.project<T>(Vector3<T>(point_camera - way))) /
         T(2 * kStep_s);
}

/// What a marker's blur should be: px², xx, xy, yy. `state` is the robot's motion when the image was valid,
/// `panel` its panel's nominal pose, `lens_px2` what lens and pixels blur, alike to all sides. What moves
/// across the image by w px while the shutter is open has a uniform blur, of variance v = w²/12 along w. The
/// normal blur that is nearest to it where a step is smoothed by s is wider: 1 + 0.15 q + 0.2 q³ times, q
/// being v / (v + s²). The first term follows from the fourth cumulant, -1.2 v², the other was fitted, to
/// ways of up to 8 px.
template <class T>
Vector3<T> predictBlur(const KinematicState<T>& state, const PanelPlacement<T>& panel,
                       const MarkerBlur& marker, const T& lens_px2, const EffectParameters<T>& effects,
                       double t_s) {
  const auto mount = cameraMounting(marker.T_robot_camera, effects, t_s);
  const auto moving = movingWith(state, mount, CameraProjector<T>::nominal(marker.camera));
  const Vector3<T> point_odom = panel.position_odom + panel.R_odom_panel * marker.point_panel.cast<T>();
  const Vector3<T> point_camera =
      mount.R_robot_sensor.transpose() *
      (state.R_odom_robot.transpose() * (point_odom - state.position_odom) - mount.position_robot);
  const Vector2<T> velocity_px_s =
      imageVelocity<T>(marker.camera, point_camera, moving.velocity_camera, moving.angular_velocity_camera);
  const ExposureTime<T> exposure = exposureTime(effects, t_s, marker.exposure_s);
  ImageSoftness<T> softness;
  applyEffects(effects, t_s, softness);
  const T to_all_sides_px2 = lens_px2 + softness.lens_px2 + kInterpolated_px2 * softness.interpolated -
                             sharpeningSeen_px2(softness.sharpened_px2);
  const T variance_px2 = exposure.squared_s2 / 12.0 * velocity_px_s.squaredNorm();
  const T q = variance_px2 / (variance_px2 + kEdgeSmoothing_px * kEdgeSmoothing_px);
  const T wider = 1.0 + 0.15 * q + 0.2 * q * q * q;
  const T share = wider * exposure.squared_s2 / 12.0;
  return {to_all_sides_px2 + share * velocity_px_s.x() * velocity_px_s.x(),
          share * velocity_px_s.x() * velocity_px_s.y(),
          to_all_sides_px2 + share * velocity_px_s.y() * velocity_px_s.y()};
}

}  // namespace fathom
