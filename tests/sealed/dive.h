#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"

/// The path of a dive: smooth and known in closed form, so that rates and accelerations are exact.
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

/// Where a coordinate is, and how it changes.
struct Coordinate {
  double value = 0, rate = 0, acceleration = 0;
};

/// A sum of sines.
struct Swing {
  struct Wave {
    double amplitude, rate_rad_s, phase_rad;
  };
  double mean = 0;
  std::vector<Wave> waves{};

  Coordinate at(double t_s) const;
};

class Dive {
 public:
  /// x, y, z in odom [m], yaw, pitch, roll [rad].
  explicit Dive(std::array<Swing, 6> swings) : swings_(std::move(swings)) {}

  Motion at(double t_s) const;
  Pose poseAt(double t_s) const;

 private:
  std::array<Swing, 6> swings_;
};

/// A dive before a panel that looks along -x of odom, its middle at `panel_odom`. Amplitudes, frequencies and
/// phases are drawn from the seed.
Dive makeDive(const std::string& manoeuvre, std::uint64_t seed, const Vector3d& panel_odom);

}  // namespace fathom::sealed
