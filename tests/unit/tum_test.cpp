#include "recording/tum.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "recording/recorded_path.h"
#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {

std::vector<StampedPose> readTumText(const std::string& text) {
  const auto file = scratchFolder() / "trajectory.tum";
  writeTextFile(file, text);
  return readTum(file);
}

std::string tumErrorOf(const std::string& text) {
  try {
    readTumText(text);
  } catch (const Error& error) {
    return error.where + ": " + error.why;
  }
  return "no error";
}

TEST(Tum, ReadsWhatItsFormatAllows) {
  const auto poses = readTumText(
      "# timestamp tx ty tz qx qy qz qw\n"
      "\n"
      "1700000000.0000001 1 -2 3.5 0 0 0 1\n"
      "  1.7000000005e9\t0 0 0   0 0 0.70710678 0.70710678 # half a second later\r\n");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ((poses[0].time - kStart).count(), 1);  // one tick of 100 ns
  EXPECT_EQ((poses[1].time - kStart).count(), 5'000'000);
  EXPECT_EQ(poses[0].T_odom_robot.position, Vector3d(1, -2, 3.5));
  EXPECT_EQ(poses[0].T_odom_robot.rotation, Matrix3d(Matrix3d::Identity()));
  // A quarter turn about z takes x to y.
  EXPECT_LT((poses[1].T_odom_robot.rotation * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-15);
}

TEST(Tum, NamesLineAndReason) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(tumErrorOf(good + "2 0 0 0 0 0 1\n"),
            "line 2: has 7 fields, must have 8: time tx ty tz qx qy qz qw");
  EXPECT_EQ(tumErrorOf(good + "2 0 0 0 0 0 0 1 9\n"),
            "line 2: has 9 fields, must have 8: time tx ty tz qx qy qz qw");
  EXPECT_EQ(tumErrorOf(good + "\n2 0 0 1.5m 0 0 0 1\n"), "line 3: `1.5m` is not a number");
  EXPECT_EQ(tumErrorOf(good + "2 0 0 nan 0 0 0 1\n"), "line 2: `nan` is not finite");
  EXPECT_EQ(tumErrorOf(good + "2 0 inf 0 0 0 0 1\n"), "line 2: `inf` is not finite");
  EXPECT_EQ(tumErrorOf(good + "2 0 0 0 0 0 0 1.01\n"), "line 2: the quaternion is not of unit norm");
  EXPECT_EQ(tumErrorOf(good + "1 0 0 0 0 0 0 1\n"), "line 2: time does not increase");
  EXPECT_EQ(tumErrorOf("-1 0 0 0 0 0 0 1\n"), "line 1: time is not within 1970 to 2477");
  EXPECT_EQ(tumErrorOf("1e300 0 0 0 0 0 0 1\n"), "line 1: time is not within 1970 to 2477");
  EXPECT_EQ(tumErrorOf("1,0,0,0,0,0,0,1\n"), "line 1: has 1 fields, must have 8: time tx ty tz qx qy qz qw");
  EXPECT_EQ(tumErrorOf("# only a comment\n"), ": holds no pose");
  EXPECT_EQ(tumErrorOf(""), ": holds no pose");
  EXPECT_THROW(readTum(scratchFolder() / "missing.tum"), Error);
  EXPECT_THROW(readTum(scratchFolder()), Error);
}

TEST(Tum, LinesEndSomewhereAndAMarkOfUtf8IsNoNumber) {
  const std::string good = "1 0 0 0 0 0 0 1";
  EXPECT_EQ(readTumText("\xEF\xBB\xBF" + good + "\r\n2 0 0 0 0 0 0 1").size(), 2U);
  EXPECT_EQ(readTumText(good + std::string(4000, ' ') + "\n\n").size(), 1U);
  EXPECT_EQ(tumErrorOf(good + "\n" + std::string(5000, ' ') + "\n"), "line 2: is longer than 4 kB");
  EXPECT_THROW(readTum("/dev/zero"), Error);
}

// What a path cannot hold is left out of it: what is written can be read.
TEST(Tum, APathOfARecordingCanBeReadAgain) {
  const auto folder = scratchFolder();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto poseAtX = [](double seconds, double x) {
    PoseSample pose;
    pose.T_odom_robot.mean.position.x() = x;
    return Sample{after(kStart, seconds), "EKF", pose};
  };
  writeRecording(folder / "a.rawlog", {poseAtX(0, 1), poseAtX(0, 2), poseAtX(1, nan), poseAtX(2, 1e300)});
  const RecordedPath path = recordedPath(folder / "a.rawlog", "");
  EXPECT_EQ(path.left_out, 2U);
  ASSERT_EQ(path.poses.size(), 2U);
  writeTum(folder / "a.tum", path.poses);
  EXPECT_EQ(readTum(folder / "a.tum").back().T_odom_robot.position.x(), 1e300);
  writeRecording(folder / "b.rawlog", {poseAtX(0, nan)});
  EXPECT_THROW(recordedPath(folder / "b.rawlog", "EKF"), Error);

  StampedPose timeless{Time{}, {}};
  EXPECT_FALSE(fitsTum(timeless, nullptr));
  timeless.time = fromUnixSeconds(2e10);
  EXPECT_FALSE(fitsTum(timeless, nullptr));
}

TEST(Tum, NormalizesWithinTolerance) {
  const auto poses = readTumText("1 0 0 0 0 0 0 1.0009\n");
  EXPECT_NEAR(poses[0].T_odom_robot.rotation.determinant(), 1.0, 1e-15);
}

TEST(Tum, RoundTrip) {
  Random random(31);
  std::vector<StampedPose> poses;
  poses.reserve(500);
  for (int i = 0; i < 500; ++i) poses.push_back({after(kStart, 0.0100001 * i), randomPose(random)});
  const auto file = scratchFolder() / "trajectory.tum";
  writeTum(file, poses);
  const auto back = readTum(file);
  ASSERT_EQ(back.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(back[i].time, poses[i].time);
    EXPECT_LT((back[i].T_odom_robot.position - poses[i].T_odom_robot.position).norm(), 1e-9);
    EXPECT_LT(angleBetween(back[i].T_odom_robot.rotation, poses[i].T_odom_robot.rotation), 1e-11);
  }
}

TEST(Tum, LineIsAsSpecified) {
  std::ostringstream out;
  writeTumLine(out, {after(kStart, 0.5), {Matrix3d::Identity(), Vector3d(1, -2, 0.25)}});
  EXPECT_EQ(out.str(),
            "1700000000.5000000 1.000000000 -2.000000000 0.250000000 "
            "0.000000000000 0.000000000000 0.000000000000 1.000000000000\n");
}

/// Ten poses a second but for twenty seconds; and one every five seconds, which is no gap.
TEST(PoseAt, HasNothingInAGap) {
  std::vector<StampedPose> path, sparse;
  const auto pose = [](double t_s) {
    return StampedPose{after(kStart, t_s), {Matrix3d::Identity(), Vector3d(t_s, 0, 0)}};
  };
  for (int i = 0; i < 400; ++i)
    if (i <= 100 || i >= 300) path.push_back(pose(0.1 * i));
  for (int i = 0; i < 8; ++i) sparse.push_back(pose(5.0 * i));
  for (const double t_s : {0.05, 9.95, 10.0, 30.0, 30.05}) {
    ASSERT_TRUE(poseAt(path, after(kStart, t_s))) << t_s;
    EXPECT_NEAR(poseAt(path, after(kStart, t_s))->position.x(), t_s, 1e-6);
  }
  for (const double t_s : {10.01, 20.0, 29.99}) EXPECT_FALSE(poseAt(path, after(kStart, t_s))) << t_s;
  EXPECT_TRUE(poseAt(sparse, after(kStart, 12.5)));
  const std::vector<StampedPose> two{pose(0), pose(100)};
  EXPECT_TRUE(poseAt(two, after(kStart, 50)));  // nobody knows what is usual
}

TEST(Tum, SharedTruthIsRead) {
  FATHOM_NEEDS_SHARED("data/sample/none/truth.tum");
  const auto poses = readTum(sharedData("data/sample/none/truth.tum"));
  EXPECT_EQ(poses.size(), 3601U);  // 180 s at 20 Hz
  EXPECT_NEAR(secondsBetween(poses.front().time, poses.back().time), 180.0, 1e-9);
}

}  // namespace
}  // namespace fathom::test
