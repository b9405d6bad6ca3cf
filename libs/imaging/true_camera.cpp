#include "imaging/true_camera.h"

namespace fathom {

TrueCamera trueCamera(const CameraModel& nominal, const Pose& T_robot_camera,
                      const KinematicState<double>& motion, const EffectParameters<double>& effects,
                      double t_s, const Pose& T_left_right, const std::optional<Vector3d>& first_panel_odom) {
  const auto mount = cameraMounting(T_robot_camera, effects, t_s, T_left_right);
  auto projector = movingWith(motion, mount, cameraProjector(nominal, effects, t_s));
  if (nominal.above_water && first_panel_odom)
    projector.surface = surfaceBelow(motion, mount, effects, t_s, *first_panel_odom);
  return {{mount.R_robot_sensor, mount.position_robot}, projector.lensModel(nominal), projector};
}

}  // namespace fathom
