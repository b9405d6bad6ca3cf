#include "tasks/start_pose.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "recording/rawlog.h"
#include "support/shipped.h"
#include "tasks/reference_clock.h"

namespace fathom {
namespace {

const std::filesystem::path kStartedDive = test::kSource / "rawlogs/dive/dive.rawlog";

Time firstReading() {
  RawlogReader reader(kStartedDive);
  while (const auto sample = reader.next())
    if (!std::holds_alternative<RecordingHeader>(sample->reading)) return sample->time;
  return {};
}

/// Turning and moving evenly, so that any two poses tell all others.
Pose poseOf(double t_s) {
  return {expSO3<double>(t_s * Vector3d(0.1, -0.2, 0.5)), Vector3d(1, 2, 3) + t_s * Vector3d(1.5, 0, -0.2)};
}

std::vector<StampedPose> referenceFrom(double begin_s) {
  std::vector<StampedPose> reference;
  for (const double t_s : {begin_s, begin_s + 1, begin_s + 2})
    reference.push_back({after(firstReading(), t_s), poseOf(t_s)});
  return reference;
}

TEST(StartPose, IsTheReferencesAtTheFirstReading) {
  // Within the reference, at its first pose, and up to a step before it.
  for (const double begin_s : {-0.3, 0.0, 0.44, 1.0}) {
    const auto start = startPose("reference", kStartedDive, referenceFrom(begin_s));
    ASSERT_TRUE(start) << begin_s;
    EXPECT_LT((start->T_odom_robot.position - poseOf(0).position).norm(), 1e-6) << begin_s;  // stamps: 100 ns
    EXPECT_LT((start->T_odom_robot.rotation - poseOf(0).rotation).norm(), 1e-6) << begin_s;
  }
  EXPECT_THROW(startPose("reference", kStartedDive, referenceFrom(1.1)), Error);
  EXPECT_THROW(startPose("reference", kStartedDive, {{after(firstReading(), 0.1), poseOf(0.1)}}), Error);
}

/// The truth of a robot that turns back and forth, and its rawlog beside.
TEST(StartPose, IsAtTheGyrosTimeWhereTheReferencesClockIsAnother) {
  const std::filesystem::path rawlog = test::kSource / "rawlogs/trial/trial.rawlog";
  std::vector<StampedPose> truth;
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next())
    if (sample->label == labels::kTruth)
      truth.push_back({sample->time, std::get<PoseSample>(sample->reading).T_odom_robot.mean});
  EXPECT_FALSE(referenceClockOffset(rawlog, truth));
  for (const double late_s : {0.45, -1.2}) {
    std::vector<StampedPose> reference = truth;
    for (StampedPose& pose : reference) pose.time = after(pose.time, late_s);
    const auto offset_s = referenceClockOffset(rawlog, reference);
    ASSERT_TRUE(offset_s) << late_s;
    EXPECT_NEAR(*offset_s, late_s, 0.015) << late_s;  // its grid, and half an interval of the gyro
  }
}

}  // namespace
}  // namespace fathom
