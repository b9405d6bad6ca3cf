#include "estimation/motion.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "core/pose_spline.h"

namespace fathom {
namespace {

template <class T>
std::array<Matrix3<T>, 4> rotationsOf(std::span<const Pose> poses) {
  std::array<Matrix3<T>, 4> R;
  for (std::size_t i = 0; i < 4; ++i) R[i] = poses[i].rotation.cast<T>();
  return R;
}

template <class T>
Turning<T> turningOf(const std::array<Matrix3<T>, 4>& R_odom_control, const SplineWeights<T>& weights) {
  return splineTurning<T>(R_odom_control[0], turnsBetween<T>(R_odom_control), weights);
}

Vector3d sum(std::span<const Pose> poses, const std::array<double, 4>& weights) {
  Vector3d total = Vector3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) total += weights[i] * poses[i].position;
  return total;
}

template <class T>
Vector3d values(const Vector3<T>& v) {
  return {v.x().a, v.y().a, v.z().a};
}

/// Derivative of a vector of Jets, a row an axis.
template <int N>
Eigen::Matrix<double, 3, N> slopes(const Vector3<ceres::Jet<double, N>>& v) {
  Eigen::Matrix<double, 3, N> J;
  for (int i = 0; i < 3; ++i) J.row(i) = v[i].v.transpose();
  return J;
}

/// Pose at t on the polygon: linear, geodesic for the rotation; before the first and behind the last, those.
Pose onPolygon(std::span<const double> times_s, std::span<const Pose> poses, double t_s) {
  const auto later = std::upper_bound(times_s.begin(), times_s.end(), t_s);
  if (later == times_s.begin()) return poses.front();
  if (later == times_s.end()) return poses.back();
  const auto i = static_cast<std::size_t>(later - times_s.begin());
  const double share = (t_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
  const Vector3d turn = logSO3<double>(poses[i - 1].rotation.transpose() * poses[i].rotation);
  return {poses[i - 1].rotation * expSO3<double>(share * turn),
          (1.0 - share) * poses[i - 1].position + share * poses[i].position};
}

/// The node's own.
std::span<const Pose> posesOf(const PosePath& path, const MotionNode& node) {
  return std::span(path.poses).subspan(node.pose(0), static_cast<std::size_t>(node.count));
}

}  // namespace

MotionNode PosePath::nodeAt(double t_s) const {
  const double knots = (t_s - begin_s) / knot_s;
  const int first = std::clamp(static_cast<int>(std::floor(knots)), 0, static_cast<int>(poses.size()) - 4);
  return {first, 4, knots - first};
}

PosePath PosePath::splineNear(std::span<const double> times_s, std::span<const Pose> T_odom_robot,
                              double begin_s, double end_s, double knot_s) {
  PosePath path{begin_s, knot_s, {}};
  const auto segments = std::max(1, static_cast<int>(std::ceil((end_s - begin_s) / knot_s - 1e-9)));
  for (int i = -1; i < segments + 2; ++i)
    path.poses.push_back(onPolygon(times_s, T_odom_robot, begin_s + i * knot_s));
  return path;
}

PosePath PosePath::begunAt(double other_begin_s) const {
  std::vector<double> times_s;
  for (std::size_t i = 0; i < poses.size(); ++i)
    times_s.push_back(begin_s + (static_cast<double>(i) - 1.0) * knot_s);
  return splineNear(times_s, poses, other_begin_s, other_begin_s + end_s() - begin_s, knot_s);
}

Motion motionOf(const PosePath& path, const MotionNode& node) {
  const auto poses = posesOf(path, node);
  Motion motion;
  if (node.count == 0) return motion;
  if (node.count == 1) {
    motion.T_odom_robot = poses[0];
    return motion;
  }
  using Jet = ceres::Jet<double, 1>;  // by time
  const SplineWeights<double> weights(node.u, path.knot_s);
  SplineWeights<Jet> timed(Jet(node.u), path.knot_s);
  for (std::size_t j = 0; j < 3; ++j) {
    timed.value[j].v[0] = weights.rate[j];
    timed.rate[j].v[0] = weights.curvature[j];
    timed.curvature[j].v[0] = weights.jerk[j];
  }
  const Turning<Jet> turning = turningOf(rotationsOf<Jet>(poses), timed);
  motion.T_odom_robot.position = sum(poses, splineBasis(weights.value, 1.0));
  motion.velocity_odom = sum(poses, splineBasis(weights.rate, 0.0));
  motion.acceleration_odom = sum(poses, splineBasis(weights.curvature, 0.0));
  motion.jerk_odom = sum(poses, splineBasis(weights.jerk, 0.0));
  for (int i = 0; i < 9; ++i) motion.T_odom_robot.rotation(i) = turning.R_odom_robot(i).a;
  motion.rate_robot = values(turning.rate_robot);
  motion.rate_derivative_robot = values(turning.acceleration_robot);
  motion.rate_second_derivative_robot = slopes<1>(turning.acceleration_robot);
  return motion;
}

MotionJacobian motionJacobian(const PosePath& path, const MotionNode& node) {
  const auto poses = posesOf(path, node);
  if (node.count == 0) return MotionJacobian::Zero(kMotionSize, 0);
  if (node.count == 1) {
    MotionJacobian J = MotionJacobian::Zero(kMotionSize, 6);
    J.topRows<6>().setIdentity();
    return J;
  }
  using Jet = ceres::Jet<double, 12>;  // by the four rotations
  auto R = rotationsOf<Jet>(poses);
  for (std::size_t k = 0; k < 4; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const Matrix3d slope = poses[k].rotation * crossMatrix<double>(Vector3d::Unit(axis));
      for (int i = 0; i < 9; ++i) R[k](i).v[3 * static_cast<int>(k) + axis] = slope(i);
    }
  const SplineWeights<double> weights(node.u, path.knot_s);
  const Turning<Jet> turning = turningOf(R, SplineWeights<Jet>(Jet(node.u), path.knot_s));
  // d(rotation vector) from R^T dR = [d]x.
  Matrix3d attitude;
  for (int i = 0; i < 9; ++i) attitude(i) = turning.R_odom_robot(i).a;
  Eigen::Matrix<double, 3, 12> turn, rate = slopes<12>(turning.rate_robot),
                                     acceleration = slopes<12>(turning.acceleration_robot);
  for (int k = 0; k < 12; ++k) {
    Matrix3d dR;
    for (int i = 0; i < 9; ++i) dR(i) = turning.R_odom_robot(i).v[k];
    const Matrix3d skew = attitude.transpose() * dR;
    turn.col(k) << skew(2, 1), skew(0, 2), skew(1, 0);
  }
  const auto value = splineBasis(weights.value, 1.0), velocity = splineBasis(weights.rate, 0.0),
             curvature = splineBasis(weights.curvature, 0.0);
  MotionJacobian J = MotionJacobian::Zero(kMotionSize, 24);
  for (int k = 0; k < 4; ++k) {
    const auto i = static_cast<std::size_t>(k);
    J.block<3, 3>(kPositionColumn, 6 * k).diagonal().setConstant(value[i]);
    J.block<3, 3>(kVelocityColumn, 6 * k).diagonal().setConstant(velocity[i]);
    J.block<3, 3>(kAccelerationColumn, 6 * k).diagonal().setConstant(curvature[i]);
    J.block<3, 3>(kOrientationColumn, 6 * k + 3) = turn.middleCols<3>(3 * k);
    J.block<3, 3>(kRateColumn, 6 * k + 3) = rate.middleCols<3>(3 * k);
    J.block<3, 3>(kRateDerivativeColumn, 6 * k + 3) = acceleration.middleCols<3>(3 * k);
  }
  return J;
}

Pose retracted(const Pose& T, const Eigen::Ref<const Vector6d>& e) {
  return {T.rotation * expSO3<double>(e.tail<3>()), T.position + e.head<3>()};
}

}  // namespace fathom
