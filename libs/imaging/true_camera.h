#pragma once

#include <optional>

#include "imaging/camera_geometry.h"

namespace fathom {

/// A camera as it truly is at one image: its mounting, lens and lines of sight with what effects make of
/// them.
struct TrueCamera {
  Pose T_robot_camera;
  CameraModel lens;  ///< pinhole and lens alone
  CameraProjector<double> projector;

  /// Whether it sees things elsewhere than its lens has them: through a port or the water's surface, or row
  /// by row.
  bool bends() const {
    return projector.port.present || projector.dome.present || projector.surface.present ||
           projector.shutter.rolling;
  }
};

/// Of an image stamped t_s after the recording's first entry; `motion` is the robot's when it was taken
/// (validityOffset), of which a rolling shutter needs the velocities. Of a pair's right camera, the mounting
/// is the left one's. Where the map has the first panel (PanelPlacement::first_odom) and the pose in `motion`
/// say where the water's surface is: without `first_panel_odom` the camera sees none.
TrueCamera trueCamera(const CameraModel& nominal, const Pose& T_robot_camera,
                      const KinematicState<double>& motion, const EffectParameters<double>& effects,
                      double t_s, const Pose& T_left_right = {},
                      const std::optional<Vector3d>& first_panel_odom = {});

}  // namespace fathom
