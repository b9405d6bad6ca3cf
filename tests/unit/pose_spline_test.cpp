#include "core/pose_spline.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "estimation/motion.h"

namespace fathom {
namespace {

constexpr double kKnot_s = 0.2;

/// A path with up to 0.3 rad between neighbours.
PosePath randomPath(std::uint64_t seed, int count) {
  Random random(seed);
  PosePath path{-0.6, kKnot_s, {}};
  Pose pose{expSO3<double>(random.normal3()), random.normal3()};
  for (int i = 0; i < count; ++i) {
    path.poses.push_back(pose);
    pose.rotation = pose.rotation * expSO3<double>(0.15 * random.normal3());
    pose.position += 0.2 * random.normal3();
  }
  return path;
}

Motion motionAt(const PosePath& path, double t_s) { return motionOf(path, path.nodeAt(t_s)); }

/// The spline's KinematicState, from the template that is the definition.
KinematicState<double> stateAt(const PosePath& path, double t_s) {
  const MotionNode node = path.nodeAt(t_s);
  std::array<Vector3d, 4> p;
  std::array<Matrix3d, 4> R;
  for (std::size_t k = 0; k < 4; ++k) {
    p[k] = path.poses[static_cast<std::size_t>(node.first) + k].position;
    R[k] = path.poses[static_cast<std::size_t>(node.first) + k].rotation;
  }
  return splineMotion<double>(p, R[0], turnsBetween<double>(R), {node.u, path.knot_s});
}

// The closed form of even knots is Cox and de Boor's of any.
TEST(PoseSpline, WeightsOfEvenKnotsAreThoseOfAnyKnots) {
  const std::array<double, 6> knots{-0.4, -0.2, 0.0, 0.2, 0.4, 0.6};
  for (double u = 0.0; u <= 1.0; u += 0.1) {
    const SplineWeights<double> even(u, kKnot_s), any(knots, kKnot_s * u);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(even.value[j], any.value[j], 1e-14);
      EXPECT_NEAR(even.rate[j], any.rate[j], 1e-13);
      EXPECT_NEAR(even.curvature[j], any.curvature[j], 1e-12);
      EXPECT_NEAR(even.jerk[j], any.jerk[j], 1e-11);
    }
  }
}

// A cubic spline reproduces what it can: a steady twist and a parabola, to rounding.
TEST(PoseSpline, ReproducesSteadyTurningAndConstantAcceleration) {
  const Vector3d p0(1, -2, 3), v(0.3, 0.1, -0.2), a(0.05, -0.1, 0.02), rate(0.2, -0.1, 0.4);
  const Matrix3d R0 = expSO3<double>(Vector3d(0.3, 2.0, -1.0));
  PosePath path{10.0, kKnot_s, {}};
  for (int i = 0; i < 20; ++i) {
    const double t = kKnot_s * (i - 1);
    // The control points of a parabola lie beside it by -a h²/6 (second difference, weights 1/6 4/6 1/6).
    path.poses.push_back(
        {R0 * expSO3<double>(t * rate), p0 + v * t + 0.5 * a * t * t - a * (kKnot_s * kKnot_s / 6.0)});
  }
  for (double t = 0.0; t < 3.0; t += 0.07) {
    const auto state = stateAt(path, 10.0 + t);
    EXPECT_LT((state.position_odom - (p0 + v * t + 0.5 * a * t * t)).norm(), 1e-13);
    EXPECT_LT(angleBetween(state.R_odom_robot, R0 * expSO3<double>(t * rate)), 1e-7);
    EXPECT_LT((state.R_odom_robot * state.velocity_robot - (v + a * t)).norm(), 1e-12);
    EXPECT_LT((state.R_odom_robot * state.acceleration_robot - a).norm(), 1e-11);
    EXPECT_LT((state.angular_velocity_robot - rate).norm(), 1e-12);
    EXPECT_LT(state.angular_acceleration_robot.norm(), 1e-11);
  }
}

TEST(PoseSpline, ItsDerivativesAreThoseOfItsPath) {
  const PosePath path = randomPath(1, 12);
  constexpr double h = 1e-4;  // differences of the second order: 1e-8 of the third derivatives, some 100
  for (double t = -0.55; t < 1.1; t += 0.0731) {
    const Motion now = motionAt(path, t), before = motionAt(path, t - h), later = motionAt(path, t + h);
    const auto slope = [&](const Vector3d& from, const Vector3d& to) {
      return Vector3d((to - from) / (2 * h));
    };
    EXPECT_LT((slope(before.T_odom_robot.position, later.T_odom_robot.position) - now.velocity_odom).norm(),
              1e-6);
    EXPECT_LT((slope(before.velocity_odom, later.velocity_odom) - now.acceleration_odom).norm(), 1e-5);
    const Vector3d turn =
        logSO3<double>(before.T_odom_robot.rotation.transpose() * later.T_odom_robot.rotation);
    EXPECT_LT((turn / (2 * h) - now.rate_robot).norm(), 1e-6);
    EXPECT_LT((slope(before.rate_robot, later.rate_robot) - now.rate_derivative_robot).norm(), 1e-5);
    if (path.nodeAt(t - h).first != path.nodeAt(t + h).first) continue;  // jerks jump there
    EXPECT_LT((slope(before.acceleration_odom, later.acceleration_odom) - now.jerk_odom).norm(), 1e-6);
    EXPECT_LT(
        (slope(before.rate_derivative_robot, later.rate_derivative_robot) - now.rate_second_derivative_robot)
            .norm(),
        1e-4);
  }
}

TEST(PoseSpline, IsSmoothAcrossKnotsAndGoesOnBeyondItsEnds) {
  const PosePath path = randomPath(2, 12);
  constexpr double kTiny_s = 1e-10;
  for (int k = 1; k < 8; ++k) {
    const double t = path.begin_s + k * kKnot_s;
    const auto before = stateAt(path, t - kTiny_s), later = stateAt(path, t + kTiny_s);
    EXPECT_LT((before.position_odom - later.position_odom).norm(), 1e-8);
    EXPECT_LT((before.acceleration_robot - later.acceleration_robot).norm(), 1e-6);
    EXPECT_LT((before.angular_acceleration_robot - later.angular_acceleration_robot).norm(), 1e-6);
  }
  EXPECT_EQ(path.nodeAt(path.begin_s - 1).first, 0);
  EXPECT_EQ(path.nodeAt(path.end_s() + 1).first, 8);
  EXPECT_NEAR(path.nodeAt(path.end_s()).u, 1.0, 1e-9);
}

TEST(PoseSpline, MotionJacobianIsThatOfDifferences) {
  const PosePath path = randomPath(3, 7);
  const MotionNode node = path.nodeAt(path.begin_s + 2.37 * kKnot_s);
  const Motion at = motionOf(path, node);
  const MotionJacobian J = motionJacobian(path, node);
  constexpr double h = 1e-6;
  for (int c = 0; c < 24; ++c) {
    Eigen::Matrix<double, kMotionSize, 1> ends[2];
    for (const int sign : {0, 1}) {
      PosePath moved = path;
      Pose& pose = moved.poses[node.pose(c / 6)];
      pose = retracted(pose, (sign == 0 ? -h : h) * Vector6d::Unit(c % 6));
      const Motion m = motionOf(moved, node);
      ends[sign] << m.T_odom_robot.position,
          logSO3<double>(at.T_odom_robot.rotation.transpose() * m.T_odom_robot.rotation), m.velocity_odom,
          m.acceleration_odom, m.rate_robot, m.rate_derivative_robot;
    }
    // Accelerations are some 25 times larger than poses, h² times the third derivative is below 1e-8.
    EXPECT_LT(((ends[1] - ends[0]) / (2 * h) - J.col(c)).norm(), 1e-6) << c;
  }
}

}  // namespace
}  // namespace fathom
