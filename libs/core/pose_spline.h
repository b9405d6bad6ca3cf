#pragma once

#include <array>
#include <span>

#include "core/kinematics.h"

/// A path as a cumulative cubic B-spline: positions in R^3, attitude on SO(3) (Kim, Kim & Shin 1995).
/// Position and attitude are C2, so that velocity, angular velocity and acceleration are what one set of
/// control poses says and need no states of their own. A segment has four control poses.
namespace fathom {

/// The three cumulative weights of a segment and their derivatives by time, 1, 1/s, 1/s², 1/s³.
template <class T>
struct SplineWeights {
  std::array<T, 3> value, rate, curvature;
  std::array<double, 3> jerk;

  /// Knots knot_s apart, at u in [0, 1] of the segment (Sommer et al. 2020, eq. 15, order 4).
  SplineWeights(const T& u, double knot_s) {
    const double per_s = 1.0 / knot_s, per_s2 = per_s * per_s;
    const T u2 = u * u, u3 = u2 * u;
    value = {(5.0 + 3.0 * u - 3.0 * u2 + u3) / 6.0, (1.0 + 3.0 * u + 3.0 * u2 - 2.0 * u3) / 6.0, u3 / 6.0};
    rate = {(0.5 - u + 0.5 * u2) * per_s, (0.5 + u - u2) * per_s, 0.5 * u2 * per_s};
    curvature = {(u - 1.0) * per_s2, (1.0 - 2.0 * u) * per_s2, u * per_s2};
    jerk = {per_s2 * per_s, -2.0 * per_s2 * per_s, per_s2 * per_s};
  }

  /// Uneven knots, s: the six around the segment [knots[2], knots[3]], at time t. Cox-de Boor; a cumulative
  /// weight is a sum of basis functions whose derivatives telescope to 3 B_{j,2} / (knots[j+3] - knots[j]).
  SplineWeights(std::span<const double, 6> knots, const T& t) {
    const auto k = knots;
    const double span1 = k[3] - k[2];
    const double span2[2] = {k[3] - k[1], k[4] - k[2]};
    const double span3[3] = {k[3] - k[0], k[4] - k[1], k[5] - k[2]};
    const T linear[2] = {(k[3] - t) / span1, (t - k[2]) / span1};
    const T first = (k[3] - t) / span2[0] * linear[0], last = (t - k[2]) / span2[1] * linear[1];
    const T quadratic[3] = {first, 1.0 - first - last, last};
    value = {1.0 - (k[3] - t) / span3[0] * quadratic[0], (t - k[1]) / span3[1] * quadratic[1] + last,
             (t - k[2]) / span3[2] * last};
    const T slope[3] = {-linear[0] / span2[0], linear[0] / span2[0] - linear[1] / span2[1],
                        linear[1] / span2[1]};
    const double bend[3] = {1.0 / (span1 * span2[0]), -1.0 / (span1 * span2[0]) - 1.0 / (span1 * span2[1]),
                            1.0 / (span1 * span2[1])};
    for (std::size_t j = 0; j < 3; ++j) {
      rate[j] = 3.0 / span3[j] * quadratic[j];
      curvature[j] = 6.0 / span3[j] * slope[j];
      jerk[j] = 6.0 / span3[j] * bend[j];
    }
  }
};

/// Weights of the four control positions themselves in a cumulative sum: b_0 = 1 - w_1, b_i = w_i - w_i+1.
template <class T>
std::array<T, 4> splineBasis(const std::array<T, 3>& cumulative, double first) {
  return {first - cumulative[0], cumulative[0] - cumulative[1], cumulative[1] - cumulative[2], cumulative[2]};
}

/// Attitude, and the body's angular velocity (rad/s) and acceleration (rad/s²) in its own axes.
template <class T>
struct Turning {
  Matrix3<T> R_odom_robot;
  Vector3<T> rate_robot = Vector3<T>::Zero(), acceleration_robot = Vector3<T>::Zero();
};

/// Of the first control attitude and the rotation vectors from each to the next, in its axes. Rate and
/// acceleration by recursion through the product's factors (Sommer et al. 2020, "Efficient derivative
/// computation for cumulative B-splines on Lie groups", eqs. 24 to 29).
template <class T>
Turning<T> splineTurning(const Matrix3<T>& R_odom_first, const std::array<Vector3<T>, 3>& turns,
                         const SplineWeights<T>& weights) {
  Turning<T> turning{R_odom_first};
  for (std::size_t j = 0; j < 3; ++j) {
    const Vector3<T>& turn = turns[j];
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

/// The rotation vectors between four control attitudes, neighbours less than pi apart.
template <class T>
std::array<Vector3<T>, 3> turnsBetween(const std::array<Matrix3<T>, 4>& R_odom_control) {
  std::array<Vector3<T>, 3> turns;
  for (std::size_t j = 0; j < 3; ++j)
    turns[j] = logSO3<T>(R_odom_control[j].transpose() * R_odom_control[j + 1]);
  return turns;
}

/// The whole motion of a segment: position's steps by the same cumulative weights as the turns.
template <class T>
KinematicState<T> splineMotion(const std::array<Vector3<T>, 4>& position_odom, const Matrix3<T>& R_odom_first,
                               const std::array<Vector3<T>, 3>& turns, const SplineWeights<T>& weights) {
  const Turning<T> turning = splineTurning<T>(R_odom_first, turns, weights);
  KinematicState<T> state;
  Vector3<T> velocity_odom = Vector3<T>::Zero(), acceleration_odom = Vector3<T>::Zero();
  state.position_odom = position_odom[0];
  for (std::size_t j = 0; j < 3; ++j) {
    const Vector3<T> step = position_odom[j + 1] - position_odom[j];
    state.position_odom += weights.value[j] * step;
    velocity_odom += weights.rate[j] * step;
    acceleration_odom += weights.curvature[j] * step;
  }
  state.R_odom_robot = turning.R_odom_robot;
  state.velocity_robot = state.R_odom_robot.transpose() * velocity_odom;
  state.acceleration_robot = state.R_odom_robot.transpose() * acceleration_odom;
  state.angular_velocity_robot = turning.rate_robot;
  state.angular_acceleration_robot = turning.acceleration_robot;
  return state;
}

}  // namespace fathom
