#include "simulation/trajectory.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "support/motions.h"

namespace fathom {
namespace {

using test::randomPoses;
using test::sinePose;
using test::sineTrajectory;

TEST(Trajectory, PassesThroughItsPoses) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto [times_s, poses] = randomPoses(seed, 4 + 3 * seed);
    const Trajectory trajectory(times_s, poses);
    EXPECT_EQ(trajectory.start_s(), times_s.front());
    EXPECT_EQ(trajectory.end_s(), times_s.back());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto state = trajectory.at(times_s[i]);
      EXPECT_LT((state.position_odom - poses[i].position).norm(), 1e-9) << i;
      EXPECT_LT(angleBetween(state.R_odom_robot, poses[i].rotation), 1e-9) << i;
    }
  }
}

TEST(Trajectory, PassesThroughPosesAroundAGap) {
  std::vector<double> times_s{0, 0.1, 0.2, 2.1, 2.2, 2.3, 2.4};
  std::vector<Pose> poses(times_s.size());
  std::transform(times_s.begin(), times_s.end(), poses.begin(), sinePose);
  const Trajectory trajectory(times_s, poses);
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_LT((trajectory.at(times_s[i]).position_odom - poses[i].position).norm(), 1e-9);
}

// Central differences with step h are wrong by h²/6 times the third derivative (below 1e3 here) plus rounding
// over h: 2e-8 + 1e-10 for h = 1e-5 s. Across a knot the third derivative jumps: h/4 times it for the second
// derivatives, 3e-3; those are therefore compared away from the knots.
TEST(Trajectory, DerivativesEqualNumericOnes) {
  constexpr double h = 1e-5;
  Random random(3);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto [times_s, poses] = randomPoses(seed, 20);
    const Trajectory trajectory(times_s, poses);
    for (std::size_t i = 0; i + 1 < times_s.size(); ++i) {
      const double t = times_s[i] + random.uniform(0.1, 0.9) * (times_s[i + 1] - times_s[i]);
      const auto before = trajectory.at(t - h), state = trajectory.at(t), after = trajectory.at(t + h);
      const auto odom = [](const KinematicState<double>& s) {
        return Vector3d(s.R_odom_robot * s.velocity_robot);
      };
      const Vector3d velocity_odom = (after.position_odom - before.position_odom) / (2 * h);
      const Vector3d acceleration_odom = (odom(after) - odom(before)) / (2 * h);
      const Vector3d rate = logSO3<double>(before.R_odom_robot.transpose() * after.R_odom_robot) / (2 * h);
      const Vector3d rate_change = (after.angular_velocity_robot - before.angular_velocity_robot) / (2 * h);
      EXPECT_LT((odom(state) - velocity_odom).norm(), 1e-6);
      EXPECT_LT((state.R_odom_robot * state.acceleration_robot - acceleration_odom).norm(), 1e-6);
      EXPECT_LT((state.angular_velocity_robot - rate).norm(), 1e-6);
      EXPECT_LT((state.angular_acceleration_robot - rate_change).norm(), 1e-6);
    }
  }
}

TEST(Trajectory, JetsInTimeGiveTheSameDerivatives) {
  using Jet = ceres::Jet<double, 1>;
  const auto [times_s, poses] = randomPoses(7, 30);
  const Trajectory trajectory(times_s, poses);
  Random random(4);
  const auto derivative = [](const auto& m) {
    return m.unaryExpr([](const Jet& j) { return j.v[0]; }).eval();
  };
  for (int i = 0; i < 200; ++i) {
    const double t = random.uniform(times_s.front(), times_s.back());
    const auto state = trajectory.at(t);
    const auto jet = trajectory.at(Jet(t, 0));
    const Matrix3d R = state.R_odom_robot;
    EXPECT_LT((R.transpose() * derivative(jet.position_odom) - state.velocity_robot).norm(), 1e-11);
    EXPECT_LT(
        (R.transpose() * derivative(jet.R_odom_robot) - crossMatrix<double>(state.angular_velocity_robot))
            .norm(),
        1e-11);
    EXPECT_LT((derivative(jet.angular_velocity_robot) - state.angular_acceleration_robot).norm(), 1e-10);
    // d(R^T v_odom)/dt = acceleration_robot - omega x velocity_robot
    EXPECT_LT((derivative(jet.velocity_robot) + state.angular_velocity_robot.cross(state.velocity_robot) -
               state.acceleration_robot)
                  .norm(),
              1e-10);
  }
}

TEST(Trajectory, IsSmoothAcrossItsPoses) {
  const auto [times_s, poses] = randomPoses(9, 30);
  const Trajectory trajectory(times_s, poses);
  for (std::size_t i = 1; i + 1 < times_s.size(); ++i) {
    const auto left = trajectory.at(times_s[i] - 1e-9), right = trajectory.at(times_s[i] + 1e-9);
    // Third derivatives below 1e4 times the 2e-9 s in between.
    EXPECT_LT((left.velocity_robot - right.velocity_robot).norm(), 2e-5);
    EXPECT_LT((left.acceleration_robot - right.acceleration_robot).norm(), 2e-5);
    EXPECT_LT((left.angular_velocity_robot - right.angular_velocity_robot).norm(), 2e-5);
    EXPECT_LT((left.angular_acceleration_robot - right.angular_acceleration_robot).norm(), 2e-5);
  }
}

// A cubic spline through samples h apart is wrong by 5/384 h^4 times the fourth derivative inside: halving h
// gains 16, here asked for 10. The velocity gains 8, here asked for 6.
TEST(Trajectory, ConvergesToTheMotionItSamples) {
  const auto errors = [](double interval_s) {
    const Trajectory trajectory = sineTrajectory(60, interval_s);
    double position = 0, velocity = 0, angle = 0;
    for (const double t : test::timesBetween(20, 40, 0.0137)) {
      const auto state = trajectory.at(t);
      const Vector3d truth_odom(2.0 * 0.23 * std::cos(0.23 * t), 1.5 * 0.17 * std::cos(0.17 * t + 1.0),
                                0.6 * 0.29 * std::cos(0.29 * t));
      position = std::max(position, (state.position_odom - sinePose(t).position).norm());
      velocity = std::max(velocity, (state.R_odom_robot * state.velocity_robot - truth_odom).norm());
      angle = std::max(angle, angleBetween(state.R_odom_robot, sinePose(t).rotation));
    }
    return Vector3d(position, velocity, angle);
  };
  const Vector3d coarse = errors(0.8), fine = errors(0.4);
  EXPECT_GT(coarse[0] / fine[0], 10);
  EXPECT_GT(coarse[1] / fine[1], 6);
  EXPECT_GT(coarse[2] / fine[2], 10);
  EXPECT_LT(fine[0], 5.0 / 384 * std::pow(0.4, 4) * 2 * std::pow(0.29, 4) * 2);
}

TEST(Trajectory, EndsAreNatural) {
  const auto [times_s, poses] = randomPoses(11, 12);
  const Trajectory trajectory(times_s, poses);
  for (const double t : {times_s.front(), times_s.back()}) {
    EXPECT_LT(trajectory.at(t).acceleration_robot.norm(), 1e-9);
    EXPECT_LT(trajectory.at(t).angular_acceleration_robot.norm(), 1e-9);
  }
}

TEST(Trajectory, TumTimesCountFromTheFirst) {
  const Time start = fromUnixSeconds(1.7e9);
  std::vector<StampedPose> poses(6);
  for (std::size_t i = 0; i < 6; ++i) {
    const double t = 0.5 * static_cast<double>(i);
    poses[i] = {after(start, t), sinePose(t)};
  }
  const Trajectory trajectory = Trajectory::fromTum(poses);
  EXPECT_EQ(trajectory.start_s(), 0.0);
  EXPECT_EQ(trajectory.end_s(), 2.5);
  EXPECT_LT((trajectory.at(1.5).position_odom - sinePose(1.5).position).norm(), 1e-9);
}

TEST(Trajectory, RefusesWhatItCannotInterpolate) {
  const auto with = [](const std::vector<double>& times_s, double turn = 0.1) {
    std::vector<Pose> poses(times_s.size());
    for (std::size_t i = 0; i < times_s.size(); ++i)
      poses[i].rotation = rotationFromYawPitchRoll(turn * static_cast<double>(i), 0, 0);
    const Trajectory trajectory(times_s, poses, "run.tum");
  };
  EXPECT_NO_THROW(with({0, 1, 2, 3}));
  EXPECT_THROW(with({}), Error);
  EXPECT_THROW(with({0, 1, 2}), Error);
  EXPECT_THROW(with({0, 1, 1, 2}), Error);
  EXPECT_THROW(with({0, 2, 1, 3}), Error);
  EXPECT_THROW(with({0, 1, 2, 23}), Error);
  EXPECT_THROW(with({0, 1, 2, std::nan("")}), Error);
  EXPECT_THROW(with({0, 1, 2, 3}, 2.1), Error);
  try {
    with({0, 1, 2, 23});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.file, "run.tum");
    EXPECT_EQ(error.where, "pose 4");
  }
  EXPECT_THROW(Trajectory({0, 1, 2, 3, 4}, std::vector<Pose>(4)), Error);
}

}  // namespace
}  // namespace fathom
