// A bag recorded by others on a real robot.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "support/bags.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

using test::vehicleOf;

class Husky : public testing::Test {
 protected:
  void SetUp() override {
    FATHOM_NEEDS_SHARED("data/robot_localization/test1.bag");
    map = readTopicMap(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/husky_topics.yaml");
  }
  ImportedRecording import() const {
    return importBag(test::sharedData("data/robot_localization/test1.bag"), map);
  }
  TopicMap map;
};

TEST_F(Husky, HasTheMessagesTheBagCounts) {
  const auto recording = import();
  std::map<std::string, int> counts;
  for (const Sample& s : recording.samples) ++counts[s.label];
  EXPECT_EQ(counts["INS"], 11865);  // rosbag info
  EXPECT_EQ(counts["DVL"], 3952);
  EXPECT_EQ(recording.reference.size(), 3952U);
  EXPECT_TRUE(std::is_sorted(recording.samples.begin(), recording.samples.end(),
                             [](const Sample& a, const Sample& b) { return a.time < b.time; }));
  EXPECT_NEAR(toUnixSeconds(recording.start), 1432235497.988949, 1e-6);
  const Vehicle vehicle = vehicleOf(recording);
  EXPECT_NEAR(vehicle.ins->rate_hz, 30.0, 0.1);
  EXPECT_NEAR(vehicle.dvl->rate_hz, 10.0, 0.1);
  EXPECT_NEAR(vehicle.ins->gyro_sigma_rad_s, 0.02, 1e-3);
}

/// Independent of the importer's own checks: with the map's mounting the robot stands upright, and its yaw
/// rate by the gyro is that of the wheels.
TEST_F(Husky, MountingMakesTheRobotUpright) {
  Vector3d force_robot = Vector3d::Zero();
  double count = 0, worst_tilt = 0;
  for (const Sample& s : import().samples)
    if (const auto* ins = std::get_if<InsSample>(&s.reading)) {
      force_robot += ins->T_robot_ins.rotation * *ins->specific_force_ins;
      const Matrix3d R_odom_robot = *ins->R_odom_ins * ins->T_robot_ins.rotation.transpose();
      worst_tilt = std::max(worst_tilt, std::acos(R_odom_robot(2, 2)));
      ++count;
    }
  EXPECT_LT((force_robot / count - Vector3d(0, 0, 9.80665)).norm(), 0.3) << force_robot.transpose() / count;
  EXPECT_LT(worst_tilt, radians(20)) << "a wheeled robot outdoors does not lie on its side";
}

TEST_F(Husky, ConcludesThatTheOrientationIsTheSensorsOwn) {
  const auto said = [](const ImportedRecording& recording, const std::string& what) {
    for (const Conclusion& c : recording.conclusions)
      if (c.what == what) return c;
    ADD_FAILURE() << "nothing on " << what;
    return Conclusion{};
  };
  auto orientation = said(import(), "orientation in the INS's messages");
  EXPECT_EQ(orientation.concluded, "the sensor's own attitude, as the map says");
  EXPECT_GT(orientation.residual_ratio, 10.0);
  auto mounting = said(import(), "INS mounting against odometry");
  EXPECT_EQ(mounting.concluded, "the map's pose fits best of the 24 right-angled ones");

  map.topics[0].orientation_is_robot = true;
  orientation = said(import(), "orientation in the INS's messages");
  EXPECT_EQ(orientation.concluded, "the sensor's own attitude, but the map says otherwise");
  // A drawing that is wrong by a quarter turn about the vertical, which gravity cannot see.
  map.topics[0].T_robot_sensor.rotation =
      rotationFromYawPitchRoll(radians(90), 0, 0) * map.topics[0].T_robot_sensor.rotation;
  mounting = said(import(), "INS mounting against odometry");
  EXPECT_EQ(mounting.concluded, "axes (y, -x, z) after the map's pose fit better (not corrected)");
}

}  // namespace
}  // namespace fathom
