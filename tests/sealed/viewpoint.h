#pragma once

#include "dive.h"
#include "port.h"
#include "sealed_case.h"
#include "vehicle.h"

namespace fathom::sealed {

/// Where the camera is, and when each of its rows is taken.
class Viewpoint {
 public:
  Viewpoint(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive);

  /// Of an image that is stamped `stamp_s`, at time t_s.
  Pose T_odom_camera(double t_s, double stamp_s) const;
  /// When an image was taken that is stamped so.
  double trueTime_s(double stamp_s) const;
  /// The middle of this row's exposure.
  double rowTime_s(double row_px, double stamp_s) const;
  /// Where a point of odom is seen by the row that sees it; nothing where it is behind the camera.
  std::optional<Vector2d> pixelOf(const TrueCamera& camera, const Vector3d& point_odom, double stamp_s) const;

 private:
  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  const Dive& dive_;
  double shake_rad_, shake_phase_rad_;
};

}  // namespace fathom::sealed
