// A reference from a bag's transforms, written by rosbag itself.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/kinematics.h"
#include "support/bags.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

using test::bagTopic;
using test::rosTime;
using test::topicMap;

ros1::TransformStamped transform(const std::string& parent, const std::string& child, ros::Time stamp,
                                 const Pose& pose) {
  auto message = test::stamped<ros1::TransformStamped>(stamp);
  message.header.frame_id = parent;
  message.child_frame_id = child;
  const Eigen::Quaterniond q(pose.rotation);
  message.transform.translation.x = pose.position.x();
  message.transform.translation.y = pose.position.y();
  message.transform.translation.z = pose.position.z();
  message.transform.rotation.w = q.w();
  message.transform.rotation.x = q.x();
  message.transform.rotation.y = q.y();
  message.transform.rotation.z = q.z();
  return message;
}

/// A robot in a turn: map to odom corrects once a second, odom to the robot's footprint comes at 10 Hz, the
/// robot over its footprint and the camera stand still on it; somebody else's arm moves, too.
class BagTransforms : public testing::Test {
 protected:
  static Pose correction(double t_s) { return {rotationFromYawPitchRoll(0.1 * t_s, 0, 0), {1 + t_s, 2, 0}}; }
  static Pose odometry(double t_s) {
    return {rotationFromYawPitchRoll(0.2 * t_s, 0.05, 0), {0.3 * t_s, 0, -5}};
  }
  static constexpr int kTenths = 40;

  void write() {
    rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
    ros1::TFMessage statics;
    statics.transforms.push_back(
        transform("footprint", "base_link", rosTime(0), footprint_));  // without a stamp, as some have it
    statics.transforms.push_back(transform("base_link", "camera", rosTime(100), camera_));
    bag.write("/tf_static", rosTime(100), statics);
    for (int k = 0; k <= kTenths; ++k) {
      const ros::Time stamp = rosTime(100 + static_cast<unsigned>(k) / 10, k % 10 * 100000000U);
      ros1::TFMessage message;
      message.transforms.push_back(transform("/odom", "footprint", stamp, odometry(0.1 * k)));
      message.transforms.push_back(transform("base_link", "arm", stamp, odometry(k)));
      if (k % 10 == 0) message.transforms.push_back(transform("map", "odom", stamp, correction(0.1 * k)));
      bag.write("/tf", stamp, message);
      bag.write("/imu", stamp, test::imuMessage(stamp));
    }
    bag.close();
  }

  static ros::Time tenth(int k, unsigned later_ns = 0) {
    return rosTime(100 + static_cast<unsigned>(k) / 10, k % 10 * 100000000U + later_ns);
  }
  /// Received when it was stamped.
  static void write(rosbag::Bag& bag, const std::string& topic, const ros1::TransformStamped& transform) {
    write(bag, topic, transform, transform.header.stamp);
  }
  static void write(rosbag::Bag& bag, const std::string& topic, const ros1::TransformStamped& transform,
                    ros::Time arrival) {
    ros1::TFMessage message;
    message.transforms.push_back(transform);
    bag.write(topic, arrival, message);
  }
  /// From odom to base_link, and an IMU.
  static void writeOdometry(rosbag::Bag& bag, const std::string& topic) {
    for (int k = 0; k <= kTenths; ++k) {
      write(bag, topic, transform("odom", "base_link", tenth(k), odometry(0.1 * k)));
      bag.write("/imu", tenth(k), test::imuMessage(tenth(k)));
    }
  }

  ImportedRecording imported(const std::string& frame, const std::string& child_frame,
                             const std::string& name = "/tf") const {
    BagTopic topic = bagTopic(name, TopicRole::reference);
    topic.T_robot_sensor = Pose{};
    topic.frame = frame;
    topic.child_frame = child_frame;
    return importBag(file_, topicMap({bagTopic("/imu", TopicRole::ins), topic}));
  }
  std::vector<StampedPose> referenceOf(const std::string& frame, const std::string& child_frame) const {
    return imported(frame, child_frame).reference;
  }
  static void expectRemark(const ImportedRecording& recording, const std::string& part) {
    ASSERT_EQ(recording.remarks.size(), 1U);
    EXPECT_NE(recording.remarks[0].find(part), std::string::npos) << recording.remarks[0];
  }
  void expectError(const std::string& frame, const std::string& child_frame, const std::string& part,
                   const std::string& name = "/tf") const {
    try {
      imported(frame, child_frame, name);
      ADD_FAILURE() << "accepted, instead of: " << part;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  }
  /// To the 100 ns of stamps.
  static void expectNear(const Pose& pose, const Pose& expected) {
    EXPECT_LT((pose.position - expected.position).norm(), 1e-6);
    EXPECT_LT(angleBetween(pose.rotation, expected.rotation), 1e-6);
  }

  const std::filesystem::path file_ = test::scratchFolder() / "test.bag";
  const Pose footprint_{rotationFromYawPitchRoll(0, 0, 0.1), {0, 0, 0.5}},
      camera_{rotationFromYawPitchRoll(1, -0.4, 0), {0.3, -0.2, 0.1}};
};

TEST_F(BagTransforms, AreFollowedThroughWhatLiesBetween) {
  write();
  const auto path = referenceOf("map", "camera");
  ASSERT_EQ(path.size(), kTenths + 1U);
  for (std::size_t k = 0; k < path.size(); k += 5) {
    // The correction turns and moves evenly, so that halfway between two it is exactly halfway.
    const double t_s = 0.1 * static_cast<double>(k);
    expectNear(path[k].T_odom_robot, correction(t_s) * odometry(t_s) * footprint_ * camera_);
  }
}

TEST_F(BagTransforms, AreTurnedRoundWhereTheyPointTheOtherWay) {
  write();
  const auto path = referenceOf("base_link", "/odom");
  ASSERT_EQ(path.size(), kTenths + 1U);
  expectNear(path[7].T_odom_robot, (odometry(0.7) * footprint_).inverse());
}

TEST_F(BagTransforms, SayWhatIsMeantAndWhatIsThere) {
  write();
  expectError("", "",
              "`frame` and `child_frame` must tell: base_link to arm, base_link to camera (static), ");
  expectError("map", "dvl", "nothing joins dvl to map");
  expectError("base_link", "camera", "camera stands still in base_link");
}

TEST_F(BagTransforms, OfOnlyOneThatMovesNeedNoFrames) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  for (unsigned k = 0; k < 5; ++k) {
    bag.write("/imu", rosTime(100 + k), test::imuMessage(rosTime(100 + k)));
    bag.write("/tf", rosTime(100 + k), transform("odom", "base_link", rosTime(100 + k), odometry(k)));
  }
  bag.close();
  const auto path = referenceOf("", "");
  ASSERT_EQ(path.size(), 5U);
  expectNear(path[3].T_odom_robot, odometry(3));
}

TEST_F(BagTransforms, OfANamespaceHaveTheirStaticOnesBeside) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  write(bag, "/robot/tf_static", transform("map", "odom", rosTime(100), camera_));
  writeOdometry(bag, "/robot/tf");
  bag.close();
  const auto recording = imported("map", "base_link", "/robot/tf");
  ASSERT_EQ(recording.reference.size(), kTenths + 1U);
  expectNear(recording.reference[7].T_odom_robot, camera_ * odometry(0.7));
  EXPECT_TRUE(recording.remarks.empty());
  expectError("world", "base_link", "/robot/tf and /robot/tf_static: nothing joins base_link to world",
              "/robot/tf");
}

TEST_F(BagTransforms, ThatCameOnceStandStill) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, "/tf");
  write(bag, "/tf", transform("map", "odom", rosTime(101), camera_));
  bag.close();
  const auto recording = imported("map", "base_link");
  ASSERT_EQ(recording.reference.size(), kTenths + 1U);
  expectNear(recording.reference[40].T_odom_robot, camera_ * odometry(4));
  expectRemark(recording, "map to odom: it came once only");
}

TEST_F(BagTransforms, OfTwoPublishersAreRemarked) {
  const Pose elsewhere{Matrix3d::Identity(), {3, 0, 0}};
  for (const unsigned later_ns : {0U, 20000000U}) {
    rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
    writeOdometry(bag, "/tf");
    for (int k = 0; k <= kTenths; ++k)
      write(bag, "/tf", transform("odom", "base_link", tenth(k, later_ns), elsewhere * odometry(0.1 * k)));
    bag.close();
    expectRemark(imported("odom", "base_link"), "odom to base_link: 80 of 82 poses jump by ");
  }
}

TEST_F(BagTransforms, ThatContradictEachOtherAreRemarked) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, "/tf");
  write(bag, "/tf_static", transform("map", "odom", rosTime(100), Pose{}));
  write(bag, "/tf_static", transform("map", "odom", rosTime(102), {Matrix3d::Identity(), {0, 7, 0}}));
  bag.close();
  expectRemark(imported("map", "base_link"), "map to odom: it is static, yet said again up to 7 m and 0 deg");

  rosbag::Bag two_ways(file_.string(), rosbag::bagmode::Write);
  writeOdometry(two_ways, "/tf");
  for (int k = 0; k <= kTenths; ++k)
    write(two_ways, "/tf", transform("map", "base_link", tenth(k), odometry(0.1 * k)));
  write(two_ways, "/tf_static", transform("map", "odom", rosTime(100), {Matrix3d::Identity(), {0, 7, 0}}));
  two_ways.close();
  expectRemark(imported("map", "base_link"),
               "map to base_link: another way (map to odom, odom to base_link) says up to 7 m");
}

TEST_F(BagTransforms, OfAClockThatStepsBackAreRefused) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  writeOdometry(bag, "/tf");
  write(bag, "/tf", transform("odom", "base_link", rosTime(101), odometry(5)), rosTime(105));
  bag.close();
  expectError("odom", "base_link", "odom to base_link: its stamp steps back by 3.000 s; `stamps: arrival`");
}

TEST_F(BagTransforms, OfNothingAreSaidToBeNothing) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  bag.write("/imu", rosTime(100), test::imuMessage(rosTime(100)));
  bag.write("/tf", rosTime(100), ros1::TFMessage{});
  bag.close();
  expectError("odom", "base_link", "nothing joins base_link to odom; it has no transform");
  expectError("odom", "/odom", "`frame` and `child_frame` are the same, odom");
}

// Most bags have it; damaged or not it is nothing to a reference that is no transform.
TEST_F(BagTransforms, OfStaticFramesAloneDoNotMatterToAnotherReference) {
  rosbag::Bag bag(file_.string(), rosbag::bagmode::Write);
  ros1::TFMessage statics;
  statics.transforms.push_back(transform("base_link", "camera", rosTime(100), camera_));
  bag.write("/tf_static", rosTime(100), statics);
  for (unsigned k = 0; k < 5; ++k) {
    bag.write("/imu", rosTime(100 + k), test::imuMessage(rosTime(100 + k)));
    auto pose = test::stamped<ros1::PoseStamped>(rosTime(100 + k));
    pose.pose.orientation.w = 1;
    bag.write("/tf", rosTime(100 + k), pose);
  }
  bag.close();
  EXPECT_EQ(referenceOf("", "").size(), 5U);
}

}  // namespace
}  // namespace fathom
