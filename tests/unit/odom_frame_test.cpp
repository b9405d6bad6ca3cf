// What fixes make of a frame that the start defined.
#include "localization/odom_frame.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "localization/error_state_filter.h"

namespace fathom {
namespace {

constexpr FrameCoordinates kAll{true, true, true}, kPositionOnly{true, true, false};

PoseFix fixAt(double t_s, const Pose& pose, double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Vector3d::Constant(sigma_m), Vector3d::Constant(sigma_rad);
  return {t_s, "panel", kChannel<Landmark>, kAll, {pose, sigma.cwiseAbs2().asDiagonal()}};
}

PoseFix positionAt(double t_s, const Vector3d& position, double sigma_m) {
  PoseFix fix = fixAt(t_s, {Matrix3d::Identity(), position}, sigma_m, 0.0);
  fix.tells = kPositionOnly;
  fix.by = "USBL";
  return fix;
}

const Pose kTilted{rotationFromYawPitchRoll(0.3, 0.1, -0.2), {1.0, 2.0, -3.0}};
const Pose kMove{rotationFromYawPitchRoll(2.5, 0, 0), {50.0, -20.0, -4.0}};

TEST(OdomFrame, APoseMovesAllThatIsDefined) {
  OdomFrame frame(kAll);
  const auto met = frame.meet(kTilted, fixAt(0, kMove * kTilted, 0.1, 0.01));
  ASSERT_TRUE(met.move);
  EXPECT_FALSE(met.is_used_up);
  EXPECT_LT(poseDifference(met.move->T_new_old, kMove).norm(), 1e-12);
  EXPECT_FALSE(frame.defined().any());
  EXPECT_FALSE(frame.meet(kTilted, fixAt(0, kTilted, 0.1, 0.01)).move);
}

TEST(OdomFrame, WhatIsKnownIsLeftAlone) {
  OdomFrame frame({true, false, false});  // height by pressure, heading by a compass
  const auto met = frame.meet(kTilted, fixAt(0, kMove * kTilted, 0.1, 0.01));
  ASSERT_TRUE(met.move);
  EXPECT_LT(angleBetween(met.move->T_new_old.rotation, Matrix3d::Identity()), 1e-12);
  EXPECT_EQ(met.move->T_new_old.position.z(), 0.0);
  EXPECT_LT(((met.move->T_new_old * kTilted).position - (kMove * kTilted).position).head<2>().norm(), 1e-12);
  EXPECT_EQ(met.move->sigma[2], 0.0);
  EXPECT_EQ(met.move->sigma[3], 0.0);
}

TEST(OdomFrame, AStartThatWasGivenIsNeverMoved) {
  OdomFrame frame;
  EXPECT_FALSE(frame.meet(kTilted, fixAt(0, kMove * kTilted, 0.1, 0.01)).move);
}

// A path of 20 m beside positions good to 0.5 m: the heading comes from their spread.
TEST(OdomFrame, PositionsTellTheHeadingByThePath) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    OdomFrame frame(kAll);
    Pose T_odom_robot;  // the filter's, moved as it says
    const double turn = random.uniform(-3.1, 3.1), sigma_m = 0.5;
    const Pose truth{rotationFromYawPitchRoll(turn, 0, 0), {30.0, 10.0, -2.0}};
    Pose moved;  // T_now_first
    bool found = false;
    for (int i = 0; i < 60 && !found; ++i) {
      const Vector3d way(0.4 * i, 2.0 * std::sin(0.2 * i), 0.0);
      Vector3d seen = truth * way + sigma_m * random.normal3();
      if (i == 7) seen.x() += 40.0;  // one outlier
      const auto met = frame.meet({moved.rotation, moved * way}, positionAt(i, seen, sigma_m));
      ASSERT_TRUE(met.move);
      moved = met.move->T_new_old * moved;
      found = met.is_used_up;
      if (!found) {
        EXPECT_TRUE(frame.isTurned());
        EXPECT_LT((moved * way - seen).head<2>().norm(), 1e-9);  // shifted to each position
      } else {
        const double off = angleBetween(moved.rotation, truth.rotation);
        EXPECT_LT(met.move->sigma[3], radians(5.0));
        EXPECT_LT(off, 4.0 * met.move->sigma[3]) << "seed " << seed;
        EXPECT_LT((moved * way - truth * way).head<2>().norm(), 4.0 * sigma_m) << "seed " << seed;
      }
    }
    EXPECT_TRUE(found);
    EXPECT_FALSE(frame.isTurned());
  }
}

TEST(OdomFrame, MostOfTheFirstFixesAgreeOnTheStart) {
  const OdomFrame frame(kAll);
  const Pose wrong{rotationFromYawPitchRoll(-1.0, 0.4, 0.0), {5.0, 5.0, -9.0}};
  std::vector<ReckonedFix> fixes;
  for (int i = 0; i < 4; ++i) {
    const Pose way{rotationFromYawPitchRoll(0.05 * i, 0, 0), {0.2 * i, 0.0, 0.0}};
    fixes.push_back({fixAt(0.5 * i, i == 0 ? wrong : kMove * way, 0.05, 0.01), way});
  }
  const auto agreed = consensus(frame, fixes);
  ASSERT_TRUE(agreed);
  EXPECT_EQ(agreed->agreeing, 3u);
  EXPECT_EQ(agreed->of, 4u);
  EXPECT_EQ(agreed->by, &fixes[1].fix);
  EXPECT_LT(poseDifference(agreed->move.T_new_old, kMove).norm(), 1e-9);
  EXPECT_FALSE(consensus(OdomFrame{}, fixes));
}

// Two things that stand in one frame stand to each other as before, and as surely, wherever the frame is put.
TEST(MoveFrame, LeavesWhatIsRelativeAlone) {
  using Filter = ErrorStateFilter<kFullSize>;
  Random random(3);
  Filter filter;
  filter.x.motion.R_odom_robot = kTilted.rotation;
  filter.x.motion.position_odom = kTilted.position;
  filter.P *= 0.01;
  filter.attach({{rotationFromYawPitchRoll(1.0, 0.2, 0.1), {4.0, 1.0, 0.5}}, 1e-4 * Matrix6d::Identity()});
  const auto relative = [](const Filter& f) {
    const LinkedPose link =
        between({f.x.motion.R_odom_robot, f.x.motion.position_odom}, f.attached.T_odom[0]);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, f.wholeCovariance().rows());
    J.leftCols<6>() = link.wrt_first;
    J.rightCols<6>() = link.wrt_second;
    return UncertainPose{link.pose, J * f.wholeCovariance() * J.transpose()};
  };
  const UncertainPose before = relative(filter);
  const double floor_below = filter.x.sea_floor_z_m - filter.x.motion.position_odom.z();
  FrameMove move{kMove, {7.0, 8.0, 9.0}, {2.0, 3.0, 4.0, 0.5}};
  filter.moveFrame(move);
  const UncertainPose after = relative(filter);
  EXPECT_LT(poseDifference(before.pose, after.pose).norm(), 1e-12);
  EXPECT_LT((before.covariance - after.covariance).norm(), 1e-10);
  EXPECT_NEAR(filter.x.sea_floor_z_m - filter.x.motion.position_odom.z(), floor_below, 1e-12);
  EXPECT_LT(
      poseDifference({filter.x.motion.R_odom_robot, filter.x.motion.position_odom}, kMove * kTilted).norm(),
      1e-12);
  // Of the height: the shift's own, and what the filter had.
  EXPECT_NEAR(filter.P(2, 2), 0.01 + 16.0, 1e-9);
}

}  // namespace
}  // namespace fathom
