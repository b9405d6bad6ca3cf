#include "ros_bag/topic_map.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

const std::string kPose = "pose: {x: 1, y: 2, z: 3, yaw_deg: 90, pitch_deg: 0, roll_deg: 0}";

TopicMap readTopics(const std::string& text) {
  const auto file = test::scratchFolder() / "topics.yaml";
  writeTextFile(file, text);
  return readTopicMap(file);
}

void expectError(const std::string& text, const std::string& part) {
  try {
    readTopics(text);
    ADD_FAILURE() << "accepted: " << text;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST(TopicMap, ReadsRolesPosesAndFields) {
  const TopicMap map = readTopics("description: pool\ntopics:\n  - {topic: /imu, as: INS, " + kPose +
                                  ", use: [rate], orientation_of: robot}\n  - {topic: /r0, as: DVL_BEAMS, " +
                                  kPose + "}\n  - {topic: /r1, as: DVL_BEAMS, " + kPose + "}\n");
  EXPECT_EQ(map.description, "pool");
  EXPECT_EQ(map.gravity_m_s2, 9.80665);
  ASSERT_EQ(map.topics.size(), 3U);
  EXPECT_EQ(map.topics[0].as, TopicRole::ins);
  EXPECT_TRUE(map.topics[0].use_rate && !map.topics[0].use_orientation && !map.topics[0].use_acceleration);
  EXPECT_TRUE(map.topics[0].orientation_is_robot);
  EXPECT_TRUE(map.topics[0].T_robot_sensor.rotation.col(0).isApprox(Vector3d::UnitY()));
  EXPECT_EQ(map.topics[2].topic, "/r1");
}

TEST(TopicMap, ReadsIntrinsicsOfACamera) {
  const TopicMap map =
      readTopics("topics:\n  - {topic: /cam, as: CAMERA, " + kPose +
                 ", intrinsics: {width_px: 64, height_px: 48, fx_px: 50, fy_px: 51, cx_px: 32, cy_px: 24,"
                 " distortion: {k1: 0.1, k2: 0.2, p1: 0.3, p2: 0.4, k3: 0.5}}}\n");
  const CameraModel& camera = map.topics[0].intrinsics->model;
  EXPECT_EQ(camera.width_px, 64);
  EXPECT_EQ(camera.fy_px, 51);
  EXPECT_EQ(camera.p2, 0.4);
  EXPECT_EQ(camera.k3, 0.5);
}

TEST(TopicMap, ReadsTheFramesOfTransforms) {
  const std::string tf = "topics:\n  - {topic: /tf, as: REFERENCE, " + kPose;
  EXPECT_EQ(readTopics(tf + "}\n").topics[0].child_frame, "");
  const TopicMap map = readTopics(tf + ", frame: odom, child_frame: base_link}\n");
  EXPECT_EQ(map.topics[0].frame, "odom");
  EXPECT_EQ(map.topics[0].child_frame, "base_link");
  expectError(tf + ", child_frame: base_link}\n", "frame");
  expectError(tf + ", frame: odom}\n", "unknown key");
}

TEST(TopicMap, RefusesWhatItDoesNotKnow) {
  const std::string imu = "topics:\n  - {topic: /imu, as: INS, " + kPose;
  expectError("topics: []\n", "must not be empty");
  expectError("description: x\n", "topics");
  expectError(imu + ", colour: red}\n", "unknown key");
  expectError(imu + ", stamps: mine}\n", "header or arrival");
  expectError(imu + ", use: [speed]}\n", "not `speed`");
  expectError(imu + ", orientation_of: panel}\n", "sensor or robot");
  expectError(imu + "}\n  - {topic: /b, as: INS, " + kPose + "}\n", "taken by another topic");
  expectError("topics:\n  - {topic: /a, as: SONAR, " + kPose + "}\n", "not `SONAR`");
  expectError("topics:\n  - {topic: /a, as: DVL, use: [rate], " + kPose + "}\n", "unknown key");
  expectError("topics:\n  - {topic: /a, as: DVL}\n", "pose");
  expectError("topics:\n  - {as: DVL, " + kPose + "}\n", "topic");
  expectError("topics:\n  - {topic: /a, as: CAMERA, " + kPose + "}\n", "intrinsics");
}

TEST(TopicMap, ShippedMapIsReadable) {
  const TopicMap map = readTopicMap(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/husky_topics.yaml");
  EXPECT_EQ(map.topics.size(), 3U);
}

}  // namespace
}  // namespace fathom
