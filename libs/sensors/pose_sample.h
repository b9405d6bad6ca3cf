#pragma once

#include "core/uncertain_pose.h"

namespace fathom {

/// A pose or position with covariance: USBL (orientation covariance huge), TRUTH, and derived results.
struct PoseSample {
  YawPitchRollPose T_odom_robot;
  Pose T_robot_sensor{};  ///< mounting of what measured it, e.g. the USBL transponder
};

}  // namespace fathom
