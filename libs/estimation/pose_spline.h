#pragma once

#include <array>

#include "core/kinematics.h"

/// A path as a uniform cumulative cubic B-spline: positions in R^3, attitude on SO(3) (Kim, Kim & Shin 1995).
/// Position and attitude are C2, so that velocity, angular velocity and acceleration are what one set of
/// control poses says and need no states of their own.
namespace fathom {

/// The three cumulative weights of a segment at u in [0, 1] and their derivatives by time, 1, 1/s, 1/s², 1/s³
/// (Sommer et al. 2020, eq. 15, order 4).
template <class T>
struct SplineWeights {
  std::array<T, 3> value, rate, curvature;
  std::array<double, 3> jerk;

  SplineWeights(const T& u, double knot_s) {
    const double per_s = 1.0 / knot_s, per_s2 = per_s * per_s;
    const T u2 = u * u, u3 = u2 * u;
    value = {(5.0 + 3.0 * u - 3.0 * u2 + u3) / 6.0, (1.0 + 3.0 * u + 3.0 * u2 - 2.0 * u3) / 6.0, u3 / 6.0};
    rate = {(0.5 - u + 0.5 * u2) * per_s, (0.5 + u - u2) * per_s, 0.5 * u2 * per_s};
    curvature = {(u - 1.0) * per_s2, (1.0 - 2.0 * u) * per_s2, u * per_s2};
    jerk = {per_s2 * per_s, -2.0 * per_s2 * per_s, per_s2 * per_s};
  }
};

/// Attitude, and the body's angular velocity (rad/s) and acceleration (rad/s²) in its own axes.
template <class T>
struct Turning {
  Matrix3<T> R_odom_robot;
  Vector3<T> rate_robot = Vector3<T>::Zero(), acceleration_robot = Vector3<T>::Zero();
};

/// Of four control attitudes. Rate and acceleration by recursion through the product's factors (Sommer et
/// al. 2020, "Efficient derivative computation for cumulative B-splines on Lie groups", eqs. 24 to 29).
/// Neighbours less than pi apart.
template <class T>
Turning<T> splineTurning(const std::array<Matrix3<T>, 4>& R_odom_control, const SplineWeights<T>& weights) {
  Turning<T> turning{R_odom_control[0]};
  for (std::size_t j = 0; j < 3; ++j) {
    const Vector3<T> turn = logSO3<T>(R_odom_control[j].transpose() * R_odom_control[j + 1]);
    const Matrix3<T> R = expSO3<T>(weights.value[j] * turn);
    Vector3<T>& rate = turning.rate_robot;
    Vector3<T>& acceleration = turning.acceleration_robot;
    turning.R_odom_robot = turning.R_odom_robot * R;
    rate = R.transpose() * rate + weights.rate[j] * turn;
    acceleration =
        R.transpose() * acceleration + weights.curvature[j] * turn + weights.rate[j] * rate.cross(turn);
  }
  return turning;
}

/// Weights of the four control positions themselves in a cumulative sum: b_0 = 1 - w_1, b_i = w_i - w_i+1.
template <class T>
std::array<T, 4> basis(const std::array<T, 3>& cumulative, double first) {
  return {first - cumulative[0], cumulative[0] - cumulative[1], cumulative[1] - cumulative[2], cumulative[2]};
}

/// The whole motion at u in the segment of four control poses that are knot_s apart.
template <class T>
KinematicState<T> splineMotion(const std::array<Vector3<T>, 4>& position_odom,
                               const std::array<Matrix3<T>, 4>& R_odom_control, const T& u, double knot_s) {
  const SplineWeights<T> weights(u, knot_s);
  const Turning<T> turning = splineTurning<T>(R_odom_control, weights);
  const auto sum = [&](const std::array<T, 4>& b) {
    return Vector3<T>(b[0] * position_odom[0] + b[1] * position_odom[1] + b[2] * position_odom[2] +
                      b[3] * position_odom[3]);
  };
  const Matrix3<T> R_robot_odom = turning.R_odom_robot.transpose();
  KinematicState<T> state;
  state.position_odom = sum(basis(weights.value, 1.0));
  state.R_odom_robot = turning.R_odom_robot;
  state.velocity_robot = R_robot_odom * sum(basis(weights.rate, 0.0));
  state.acceleration_robot = R_robot_odom * sum(basis(weights.curvature, 0.0));
  state.angular_velocity_robot = turning.rate_robot;
  state.angular_acceleration_robot = turning.acceleration_robot;
  return state;
}

}  // namespace fathom
