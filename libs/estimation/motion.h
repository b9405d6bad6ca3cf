#pragma once

#include <Eigen/Core>
#include <compare>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "core/uncertain_pose.h"

/// The robot's motion at one time as the estimate's unknowns have it, and its derivative by them: the link
/// between what is estimated (control poses of a spline, or poses by themselves) and what sensors see.
namespace fathom {

/// Coordinates of a motion, in which sensors' models are differentiated. Of three each; orientation is a
/// rotation vector in robot axes as in UncertainPose.
enum MotionColumn : int {
  kPositionColumn = 0,
  kOrientationColumn = 3,
  kVelocityColumn = 6,
  kAccelerationColumn = 9,
  kRateColumn = 12,
  kRateDerivativeColumn = 15,
};
inline constexpr int kMotionSize = 18;

/// Motion with velocity and acceleration in odom, where they are linear in a spline's control positions.
struct Motion {
  Pose T_odom_robot;
  Vector3d velocity_odom = Vector3d::Zero(), acceleration_odom = Vector3d::Zero(),
           jerk_odom = Vector3d::Zero();
  Vector3d rate_robot = Vector3d::Zero(), rate_derivative_robot = Vector3d::Zero(),
           rate_second_derivative_robot = Vector3d::Zero();
};

/// Which poses a motion depends on: four control poses of a spline (`u` in the segment), or one pose, on
/// which the robot stands still; none for what does not ask where the robot is.
struct MotionNode {
  int first = 0, count = 1;  ///< of the poses
  double u = 0.0;

  /// Number of its k-th pose.
  std::size_t pose(int k) const { return static_cast<std::size_t>(first) + static_cast<std::size_t>(k); }
  friend auto operator<=>(const MotionNode&, const MotionNode&) = default;
};

/// The poses that are estimated.
struct PosePath {
  double begin_s = 0.0;     ///< of a spline's first segment
  double knot_s = 0.0;      ///< between its control poses; 0: poses by themselves
  std::vector<Pose> poses;  ///< T_odom_robot
  bool isSpline() const { return knot_s > 0.0; }

  /// Of a spline. Beyond its ends the outermost segments go on.
  MotionNode nodeAt(double t_s) const;
  double end_s() const { return begin_s + knot_s * static_cast<double>(poses.size() - 3); }
  /// A spline's motion, nearly, with as many control poses from another time on: they are on the polygon.
  PosePath begunAt(double other_begin_s) const;

  /// A spline over [begin, end] near poses at increasing times: its control poses are on the polygon.
  static PosePath splineNear(std::span<const double> times_s, std::span<const Pose> T_odom_robot,
                             double begin_s, double end_s, double knot_s);
};

Motion motionOf(const PosePath& path, const MotionNode& node);

/// Derivative of a motion's coordinates by the errors of the node's own poses (p, r of each, see
/// UncertainPose).
using MotionJacobian = Eigen::Matrix<double, kMotionSize, Eigen::Dynamic, 0, kMotionSize, 24>;
MotionJacobian motionJacobian(const PosePath& path, const MotionNode& node);

/// T with error e, see UncertainPose.
Pose retracted(const Pose& T, const Eigen::Ref<const Vector6d>& e);

}  // namespace fathom
