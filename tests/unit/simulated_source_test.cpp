#include "sources/simulated_source.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "recording/tum.h"
#include "support/motions.h"
#include "support/shared_data.h"
#include "support/simulated.h"
#include "support/streams.h"

namespace fathom {
namespace {

SimulationOptions options() {
  SimulationOptions result;
  result.vehicle = test::slantedVehicle();
  return result;
}

TEST(SimulatedSource, GivesWhatSimulateNavigationPushes) {
  const Trajectory trajectory = test::sineTrajectory(20);
  std::vector<Sample> pushed;
  simulateNavigation(options(), trajectory, [&](const Sample& s) { pushed.push_back(s); });
  SimulatedSource source(options(), trajectory, {"", "rov.yaml", "made"});
  const auto pulled = test::drain(source);
  EXPECT_EQ(test::fingerprints(pulled), test::fingerprints(pushed));
  EXPECT_GT(pulled.size(), 2000U);
  EXPECT_FALSE(source.next());
  EXPECT_EQ(source.header().description, "made");
}

TEST(SimulatedSource, TellsHowFarItIs) {
  SimulatedSource source(options(), test::sineTrajectory(20));
  double fraction = 0;
  while (const auto sample = source.next()) {
    EXPECT_GE(source.fraction(), fraction);
    fraction = source.fraction();
    EXPECT_NEAR(fraction, secondsBetween(SimulationOptions{}.start, sample->time) / 20, 1e-6);
  }
  EXPECT_EQ(source.fraction(), 1.0);
}

TEST(SimulatedSource, OutsideTheTrajectoryIsAnError) {
  SimulationOptions late = options();
  late.begin_s = 30;
  EXPECT_THROW(SimulatedSource(late, test::sineTrajectory(20)), Error);
}

/// The sine motion as TUM text from `start` on, 20 s.
RecordedMotion recordedMotion(Time start) {
  const auto file = test::scratchFolder() / "truth.tum";
  std::vector<StampedPose> poses;
  for (const double t : test::timesBetween(0, 20.05, 0.1))
    poses.push_back({after(start, t), test::sinePose(t)});
  writeTum(file, poses);
  return readRecordedMotion(file);
}

TEST(SimulatedSource, AlignedToARecordingItTellsTheTruthAtThoseTimes) {
  const Time begin = fromUnixSeconds(1'650'000'000.3);
  const RecordedMotion motion = recordedMotion(begin);
  EXPECT_EQ(motion.start, begin);
  SimulationOptions aligned = options();
  ASSERT_TRUE(alignTo(aligned, motion, after(begin, 5.05), after(begin, 12)));
  SimulatedSource source(aligned, motion.trajectory);
  const auto samples = test::drain(source);
  EXPECT_EQ(samples.front().time, after(begin, 5.05));
  EXPECT_LE(samples.back().time, after(begin, 12));
  EXPECT_GT(samples.back().time, after(begin, 11.98));
  for (const Sample& s : test::labelled(samples, labels::kTruth)) {
    const Pose expected = test::sinePose(secondsBetween(begin, s.time));
    const Pose got = std::get<PoseSample>(s.reading).T_odom_robot.mean;
    EXPECT_LT((expected.position - got.position).norm(), 1e-4);  // a spline through poses 0.1 s apart
  }
}

TEST(SimulatedSource, ReachesAsFarAsTheMotion) {
  const Time begin = fromUnixSeconds(1'650'000'000);
  const RecordedMotion motion = recordedMotion(begin);
  SimulationOptions aligned = options();
  ASSERT_TRUE(alignTo(aligned, motion, after(begin, -100), after(begin, 100)));
  EXPECT_EQ(aligned.start, begin);
  EXPECT_NEAR(*aligned.duration_s, 20, 1e-9);
  EXPECT_FALSE(alignTo(aligned, motion, after(begin, 21), after(begin, 100)));
  EXPECT_FALSE(alignTo(aligned, motion, after(begin, -100), after(begin, -1)));
}

}  // namespace
}  // namespace fathom
