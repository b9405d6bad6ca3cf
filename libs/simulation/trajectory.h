#pragma once

#include <string>
#include <vector>

#include "core/kinematics.h"
#include "core/time.h"
#include "recording/tum.h"

/// The true motion of the vehicle as a smooth function of time.
namespace fathom {

namespace detail {
inline double realPart(double value) { return value; }
template <class Jet>
double realPart(const Jet& value) {
  return realPart(value.a);
}

/// The three cumulative cubic B-spline weights of a segment and their derivatives, 1, 1/s and 1/s².
template <class T>
struct CumulativeWeights {
  T value[3], rate[3], curvature[3];

  /// `knots` are the six knots around the segment [knots[2], knots[3]]. Cox-de Boor; a cumulative weight is a
  /// sum of basis functions whose derivatives telescope to 3 B_{j,2} / (knots[j+3] - knots[j]).
  CumulativeWeights(const double* knots, const T& t) {
    const double* k = knots;
    const double span1 = k[3] - k[2];
    const double span2[2] = {k[3] - k[1], k[4] - k[2]};
    const double span3[3] = {k[3] - k[0], k[4] - k[1], k[5] - k[2]};
    const T linear[2] = {(k[3] - t) / span1, (t - k[2]) / span1};
    const T first = (k[3] - t) / span2[0] * linear[0], last = (t - k[2]) / span2[1] * linear[1];
    const T quadratic[3] = {first, 1.0 - first - last, last};
    value[0] = 1.0 - (k[3] - t) / span3[0] * quadratic[0];
    value[1] = (t - k[1]) / span3[1] * quadratic[1] + last;
    value[2] = (t - k[2]) / span3[2] * last;
    const T slope[3] = {-linear[0] / span2[0], linear[0] / span2[0] - linear[1] / span2[1],
                        linear[1] / span2[1]};
    for (int j = 0; j < 3; ++j) {
      rate[j] = 3.0 / span3[j] * quadratic[j];
      curvature[j] = 6.0 / span3[j] * slope[j];
    }
  }
};
}  // namespace detail

/// A cubic B-spline in R^3 x SO(3) through given poses at given, possibly uneven, times: position is C2,
/// attitude is C2 too (angular velocity C1). On SO(3) it is the cumulative B-spline of Sommer et al.,
/// "Efficient derivative computation for cumulative B-splines on Lie groups", CVPR 2020. The ends are
/// natural: no acceleration, no angular acceleration.
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
  const std::size_t i = segmentAt(detail::realPart(time_s));
  const detail::CumulativeWeights<T> weight(&knots_[i], time_s);

  KinematicState<T> state;
  Vector3<T> velocity_odom = Vector3<T>::Zero(), acceleration_odom = Vector3<T>::Zero();
  state.position_odom = T_odom_control_[i].position.cast<T>();
  state.R_odom_robot = T_odom_control_[i].rotation.cast<T>();
  for (std::size_t j = 0; j < 3; ++j) {
    const Vector3<T> step =
        (T_odom_control_[i + j + 1].position - T_odom_control_[i + j].position).template cast<T>();
    state.position_odom += weight.value[j] * step;
    velocity_odom += weight.rate[j] * step;
    acceleration_odom += weight.curvature[j] * step;

    // Sommer et al., eqs. 24-29: rate and its derivative, carried through one factor of the product.
    const Vector3<T> turn = turn_[i + j].cast<T>();
    const Matrix3<T> R = expSO3<T>(weight.value[j] * turn);
    Vector3<T>& rate = state.angular_velocity_robot;
    Vector3<T>& rate_derivative = state.angular_acceleration_robot;
    state.R_odom_robot = state.R_odom_robot * R;
    rate = R.transpose() * rate + weight.rate[j] * turn;
    rate_derivative =
        R.transpose() * rate_derivative + weight.curvature[j] * turn + weight.rate[j] * rate.cross(turn);
  }
  state.velocity_robot = state.R_odom_robot.transpose() * velocity_odom;
  state.acceleration_robot = state.R_odom_robot.transpose() * acceleration_odom;
  return state;
}

}  // namespace fathom
