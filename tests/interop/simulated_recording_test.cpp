#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "recording/rawlog.h"
#include "recording/tum.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "support/motions.h"
#include "support/shared_data.h"
#include "support/simulated.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

fs::path shippedPanel() { return fs::path(FATHOM_SOURCE_DIR) / "maps/dexrov/panel.yaml"; }
fs::path shippedVehicle() { return fs::path(FATHOM_SOURCE_DIR) / "config/rov.yaml"; }

SimulationOptions options() {
  SimulationOptions result;
  result.vehicle = readVehicle(shippedVehicle());
  result.sea_floor_z_m = -8;
  return result;
}

TEST(SimulatedRecording, ReadsBackAsItWasSimulated) {
  const auto folder = test::scratchFolder();
  const Trajectory trajectory = test::sineTrajectory(20);
  const auto files = simulateRecording(options(), trajectory,
                                       {folder, "dive", shippedVehicle(), shippedPanel(), "a test", {}});
  const auto expected = test::simulated(options(), trajectory);

  RawlogReader reader(files.rawlog);
  EXPECT_EQ(reader.header().vehicle, "dive_vehicle.yaml");
  EXPECT_EQ(reader.header().panel_map, "dive_panel/panel.yaml");
  EXPECT_EQ(reader.header().description, "a test");
  test::SamplesByLabel samples;
  while (const auto sample = reader.next())
    if (!std::holds_alternative<RecordingHeader>(sample->reading)) samples[sample->label].push_back(*sample);
  EXPECT_FALSE(reader.loss());
  ASSERT_EQ(samples.size(), expected.size());
  for (const auto& [label, list] : expected)  // ranges are stored as float: 5 m to 2.4e-7 m
    EXPECT_LE(test::largestDifference(list, samples[label]), label == labels::kDvlBeams ? 1e-6 : 1e-12)
        << label;

  EXPECT_EQ(readTextFile(folder / "dive_vehicle.yaml"), readTextFile(shippedVehicle()));
  const auto truth = readTum(files.truth);
  ASSERT_EQ(truth.size(), 201U);
  for (const StampedPose& pose : truth) {
    const auto state = trajectory.at(secondsBetween(options().start, pose.time));
    EXPECT_LT((pose.T_odom_robot.position - state.position_odom).norm(), 2e-9);
    EXPECT_LT(angleBetween(pose.T_odom_robot.rotation, state.R_odom_robot), 4e-9);
  }
}

TEST(SimulatedRecording, SameSeedSameBytes) {
  const auto folder = test::scratchFolder();
  const Trajectory trajectory = test::sineTrajectory(5);
  auto other = options();
  other.seed = 2;
  const auto bytes = [&](const SimulationOptions& o, const std::string& in) {
    return readTextFile(
        simulateRecording(o, trajectory, {folder / in, "r", shippedVehicle(), "", "", {}}).rawlog);
  };
  const std::string once = bytes(options(), "a");
  EXPECT_TRUE(once == bytes(options(), "b"));
  EXPECT_FALSE(once == bytes(other, "c"));
}

// The truth of one recording is the trajectory of the next.
TEST(SimulatedRecording, TruthIsATrajectory) {
  const auto folder = test::scratchFolder();
  const Trajectory trajectory = test::sineTrajectory(20, 0.1);
  const auto files = simulateRecording(options(), trajectory, {folder, "r", shippedVehicle(), "", "", {}});
  const Trajectory again = readTrajectory(files.truth);
  for (const double t : test::timesBetween(2, 18, 0.013)) {
    const auto a = trajectory.at(t), b = again.at(t);
    EXPECT_LT((a.position_odom - b.position_odom).norm(), 1e-8);
    // 1e-9 m of TUM text over 0.1 s, differenced once and twice.
    EXPECT_LT((a.velocity_robot - b.velocity_robot).norm(), 1e-6);
    EXPECT_LT((a.acceleration_robot - b.acceleration_robot).norm(), 1e-5);
  }
}

TEST(SimulatedRecording, FailureLeavesNothingBehind) {
  const auto folder = test::scratchFolder();
  auto too_long = options();
  too_long.duration_s = 100;
  EXPECT_THROW(
      simulateRecording(too_long, test::sineTrajectory(5), {folder, "r", shippedVehicle(), "", "", {}}),
      Error);
  EXPECT_THROW(simulateRecording(options(), test::sineTrajectory(5),
                                 {folder, "r", folder / "absent.yaml", "", "", {}}),
               Error);
  EXPECT_TRUE(fs::is_empty(folder));
}

// Somebody else's trajectory: the sample recording's truth, 20 Hz, which ours must pass through.
TEST(SimulatedRecording, FliesTheSampleRecordingsPoses) {
  FATHOM_NEEDS_SHARED("data/sample/none/truth.tum");
  const auto poses = readTum(test::sharedData("data/sample/none/truth.tum"));
  const Trajectory trajectory = readTrajectory(test::sharedData("data/sample/none/truth.tum"));
  for (const StampedPose& pose : poses) {
    const auto state = trajectory.at(secondsBetween(poses.front().time, pose.time));
    EXPECT_LT((state.position_odom - pose.T_odom_robot.position).norm(), 1e-9);
    EXPECT_LT(angleBetween(state.R_odom_robot, pose.T_odom_robot.rotation), 1e-9);
  }
}

}  // namespace
}  // namespace fathom
