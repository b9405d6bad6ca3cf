#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/kinematics.h"
#include "core/pose_spline.h"
#include "core/scalar.h"
#include "core/time.h"
#include "recording/tum.h"

/// The true motion of the vehicle as a smooth function of time.
namespace fathom {

/// A cubic B-spline in R^3 x SO(3) through given poses at given, possibly uneven, times: position is C2,
/// attitude is C2 too (angular velocity C1), see core/pose_spline.h. The ends are natural: no acceleration,
/// no angular acceleration.
class Trajectory {
 public:
  /// Times in seconds, increasing, at least four. `name` stands for the file in errors.
  /// Throws Error: fewer than four poses, as many times as poses, times not increasing or an interval more
  /// than kMaxIntervalRatio its neighbour, a turn of more than kMaxTurn between neighbours.
  Trajectory(const std::vector<double>& times_s, const std::vector<Pose>& T_odom_robot,
             const std::string& name = "trajectory");

  /// The very same poses; time counts from the first. Throws Error as above.
  static Trajectory fromTum(const std::vector<StampedPose>& poses, const std::string& name = "trajectory");

  double start_s() const { return knots_[2]; }
  double end_s() const { return knots_[knots_.size() - 3]; }

  /// The motion at a time within [start_s, end_s]; T is double or ceres::Jet. Beyond the ends the last
  /// polynomial goes on: good for rounding errors, not for seconds.
  template <class T>
  KinematicState<T> at(const T& time_s) const;

  static constexpr double kMaxIntervalRatio = 20.0;
  static constexpr double kMaxTurn = 2.0;  ///< rad

 private:
  std::size_t segmentAt(double time_s) const;
  void solveControlPoints(const std::vector<Pose>& T_odom_robot, const std::string& name);

  std::vector<double> knots_;         ///< times with two more, mirrored, beyond each end
  std::vector<Pose> T_odom_control_;  ///< one more control pose than times at each end
  std::vector<Vector3d> turn_;        ///< rotation vector from control pose i to i+1, in axes of i
};

template <class T>
KinematicState<T> Trajectory::at(const T& time_s) const {
  const std::size_t i = segmentAt(valueOf(time_s));
  std::array<Vector3<T>, 4> position_odom;
  std::array<Vector3<T>, 3> turns;
  for (std::size_t j = 0; j < 4; ++j) position_odom[j] = T_odom_control_[i + j].position.cast<T>();
  for (std::size_t j = 0; j < 3; ++j) turns[j] = turn_[i + j].cast<T>();
  return splineMotion<T>(position_odom, T_odom_control_[i].rotation.cast<T>(), turns,
                         SplineWeights<T>(std::span(knots_).subspan(i).template first<6>(), time_s));
}

}  // namespace fathom
