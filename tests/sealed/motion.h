#pragma once

#include "core/geometry.h"

namespace fathom::sealed {

/// The robot's motion at one instant.
struct Motion {
  Pose T_odom_robot;
  Vector3d velocity_odom, acceleration_odom;
  Vector3d rate_robot, angular_acceleration_robot;  ///< of robot against odom, robot axes

  /// Of a point of the robot, robot axes: rigid-body kinematics (e.g. Farrell 2008, sec. 2.6).
  Vector3d velocityOf(const Vector3d& point_robot) const {
    return T_odom_robot.rotation.transpose() * velocity_odom + rate_robot.cross(point_robot);
  }
  Vector3d accelerationOf(const Vector3d& point_robot) const {
    return T_odom_robot.rotation.transpose() * acceleration_odom +
           angular_acceleration_robot.cross(point_robot) + rate_robot.cross(rate_robot.cross(point_robot));
  }
};

}  // namespace fathom::sealed
