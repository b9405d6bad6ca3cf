// Bags written by rosbag itself.
#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "support/bags.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

using test::bagTopic;
using test::rosTime;
using test::stamped;
using test::topicMap;
using test::vehicleOf;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ros1::FluidPressure pressureMessage(ros::Time stamp, double pressure_pa) {
  auto pressure = stamped<ros1::FluidPressure>(stamp);
  pressure.fluid_pressure = pressure_pa;
  return pressure;
}

/// A bag with what `fill` writes.
std::filesystem::path makeBag(const std::function<void(rosbag::Bag&)>& fill) {
  auto file = test::scratchFolder() / "test.bag";
  rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
  fill(bag);
  bag.close();
  return file;
}

/// The message, received when it was stamped.
template <class M>
std::filesystem::path bagOf(const std::string& topic, const M& message) {
  return makeBag([&](rosbag::Bag& bag) { bag.write(topic, message.header.stamp, message); });
}

template <class R>
R onlyReading(const ImportedRecording& recording, const std::string& label) {
  EXPECT_EQ(recording.samples.size(), 1U);
  EXPECT_EQ(recording.samples.at(0).label, label);
  return std::get<R>(recording.samples.at(0).reading);
}

void expectError(const std::filesystem::path& bag, const TopicMap& map, const std::string& part) {
  try {
    importBag(bag, map, {.image_folder = bag.parent_path() / "images", .strict = true});
    ADD_FAILURE() << "accepted, instead of: " << part;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST(RosBag, Imu) {
  const auto topic = bagTopic("/imu", TopicRole::ins);
  auto imu = test::imuMessage(rosTime(1500000000, 123456789));
  imu.orientation.w = imu.orientation.z = std::sqrt(0.5);  // yaw 90 degrees
  const auto recording = importBag(bagOf("/imu", imu), topicMap({topic}));
  const auto ins = onlyReading<InsSample>(recording, labels::kIns);
  EXPECT_TRUE(ins.angular_velocity_ins->isApprox(Vector3d(0.1, 0.2, 0.3)));
  EXPECT_TRUE(ins.specific_force_ins->isApprox(Vector3d(0, 0, 9.80665)));
  EXPECT_TRUE(ins.R_odom_ins->isApprox(rotationFromYawPitchRoll(radians(90), 0, 0), 1e-12));
  EXPECT_TRUE(ins.T_robot_ins.rotation.isApprox(topic.T_robot_sensor.rotation));
  EXPECT_TRUE(ins.T_robot_ins.position.isApprox(Vector3d(1, 2, 3)));
  EXPECT_EQ(recording.start, fromUnixSeconds(1500000000) + Time::duration(1234568)) << "100 ns ticks";

  const Vehicle vehicle = vehicleOf(recording);
  EXPECT_NEAR(vehicle.ins->gyro_sigma_rad_s, 0.002, 1e-12);
  EXPECT_NEAR(vehicle.ins->accelerometer_sigma_m_s2, 0.03, 1e-12);
  EXPECT_NEAR(vehicle.ins->attitude_sigma->heading_rad, 0.01, 1e-5);
  EXPECT_NEAR(angleBetween(vehicle.ins->T_robot_ins.rotation, topic.T_robot_sensor.rotation), 0.0, 1e-8);
}

TEST(RosBag, ImuFieldsAbsentOrUnusedStayAbsent) {
  auto topic = bagTopic("/imu", TopicRole::ins);
  auto imu = test::imuMessage(rosTime(100));
  imu.orientation_covariance[0] = imu.linear_acceleration_covariance[0] = -1;
  imu.orientation.w = kNan;  // an absent field may hold anything
  auto ins = onlyReading<InsSample>(importBag(bagOf("/imu", imu), topicMap({topic})), labels::kIns);
  EXPECT_FALSE(ins.R_odom_ins || ins.specific_force_ins);
  EXPECT_TRUE(ins.angular_velocity_ins);

  topic.use_rate = topic.use_orientation = false;
  const auto bag = bagOf("/imu", test::imuMessage(rosTime(100)));
  const auto recording = importBag(bag, topicMap({topic}));
  ins = onlyReading<InsSample>(recording, labels::kIns);
  EXPECT_FALSE(ins.R_odom_ins || ins.angular_velocity_ins);
  EXPECT_FALSE(vehicleOf(recording).ins->attitude_sigma);
}

TEST(RosBag, ImuOrientationOfTheRobotIsTurnedIntoTheSensors) {
  auto topic = bagTopic("/imu", TopicRole::ins);
  topic.orientation_is_robot = true;
  const auto bag = bagOf("/imu", test::imuMessage(rosTime(100)));
  const auto ins = onlyReading<InsSample>(importBag(bag, topicMap({topic})), labels::kIns);
  EXPECT_TRUE(ins.R_odom_ins->isApprox(topic.T_robot_sensor.rotation));
}

TEST(RosBag, TwistAndOdometryBecomeDvl) {
  auto twist = stamped<ros1::TwistWithCovarianceStamped>(rosTime(100));
  twist.twist.twist.linear.x = 1.5;
  twist.twist.twist.linear.z = -0.5;
  twist.twist.covariance[0] = twist.twist.covariance[7] = 4e-4;
  twist.twist.covariance[14] = 1e-4;
  auto recording = importBag(bagOf("/dvl", twist), topicMap({bagTopic("/dvl", TopicRole::dvl)}));
  EXPECT_TRUE(onlyReading<DvlSample>(recording, labels::kDvl).velocity_dvl->isApprox(Vector3d(1.5, 0, -0.5)));
  const Vehicle vehicle = vehicleOf(recording);
  EXPECT_NEAR(vehicle.dvl->velocity_sigma_xy_m_s, 0.02, 1e-12);
  EXPECT_NEAR(vehicle.dvl->velocity_sigma_z_m_s, 0.01, 1e-12);

  auto odometry = stamped<ros1::Odometry>(rosTime(100));
  odometry.twist = twist.twist;
  recording = importBag(bagOf("/odom", odometry), topicMap({bagTopic("/odom", TopicRole::dvl)}));
  EXPECT_TRUE(onlyReading<DvlSample>(recording, labels::kDvl).velocity_dvl->isApprox(Vector3d(1.5, 0, -0.5)));
  EXPECT_TRUE(recording.reference.empty());
}

TEST(RosBag, OdometryAndPoseBecomeReference) {
  const auto imu_topic = bagTopic("/imu", TopicRole::ins);
  const auto topic = bagTopic("/pose", TopicRole::reference);
  const Pose T_odom_robot{rotationFromYawPitchRoll(1, 0.2, -0.3), Vector3d(5, 6, 7)};
  const Pose T_odom_sensor = T_odom_robot * topic.T_robot_sensor;
  const Eigen::Quaterniond q(T_odom_sensor.rotation);
  ros1::Pose pose;
  pose.position.x = T_odom_sensor.position.x();
  pose.position.y = T_odom_sensor.position.y();
  pose.position.z = T_odom_sensor.position.z();
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  pose.orientation.w = q.w();
  const auto check = [&](const auto& late, const auto& early) {
    const auto bag = makeBag([&](rosbag::Bag& b) {
      b.write("/imu", rosTime(50), test::imuMessage(rosTime(50)));
      b.write("/pose", rosTime(101), late);
      b.write("/pose", rosTime(102), early);
      b.write("/pose", rosTime(103), early);
    });
    const auto recording = importBag(bag, topicMap({imu_topic, topic}));
    EXPECT_EQ(recording.samples.size(), 1U) << "the reference never goes into the rawlog";
    ASSERT_EQ(recording.reference.size(), 2U) << "a repeated stamp counts once";
    EXPECT_EQ(recording.reference[0].time, fromUnixSeconds(50));
    EXPECT_TRUE(recording.reference[1].T_odom_robot.position.isApprox(T_odom_robot.position));
    EXPECT_TRUE(recording.reference[1].T_odom_robot.rotation.isApprox(T_odom_robot.rotation));
  };
  auto late = stamped<ros1::Odometry>(rosTime(50, 40000000)), early = stamped<ros1::Odometry>(rosTime(50));
  late.pose.pose = early.pose.pose = pose;
  check(late, early);
  auto late_pose = stamped<ros1::PoseWithCovarianceStamped>(rosTime(50, 40000000));
  auto early_pose = stamped<ros1::PoseWithCovarianceStamped>(rosTime(50));
  late_pose.pose.pose = early_pose.pose.pose = pose;
  check(late_pose, early_pose);
}

TEST(RosBag, PoseBecomesUsblPositionOfUnknownOrientation) {
  auto fix = stamped<ros1::PoseWithCovarianceStamped>(rosTime(100));
  fix.pose.pose.position.y = 4.0;
  for (std::size_t i = 0; i < 6; ++i) fix.pose.covariance[7 * i] = 0.25;
  fix.pose.covariance[1] = fix.pose.covariance[6] = 0.1;
  const auto recording = importBag(bagOf("/usbl", fix), topicMap({bagTopic("/usbl", TopicRole::usbl)}));
  const auto pdf = onlyReading<PoseSample>(recording, labels::kUsbl).T_odom_robot;
  EXPECT_EQ(pdf.mean.position.y(), 4.0);
  EXPECT_EQ(pdf.covariance(0, 0), 0.25);
  EXPECT_EQ(pdf.covariance(1, 0), 0.1);
  EXPECT_GE(pdf.covariance(3, 3), 1e6);
  EXPECT_EQ(vehicleOf(recording).usbl->position_sigma_m, 0.5);
}

TEST(RosBag, PressureBecomesDepth) {
  auto pressure = stamped<ros1::FluidPressure>(rosTime(100));
  pressure.fluid_pressure = 201325.0;
  pressure.variance = 2500.0;
  const auto recording = importBag(bagOf("/p", pressure), topicMap({bagTopic("/p", TopicRole::depth)}));
  EXPECT_EQ(onlyReading<DepthSample>(recording, labels::kDepth).pressure_pa, 201325.0);
  EXPECT_EQ(vehicleOf(recording).depth->pressure_sigma_pa, 50.0);
}

TEST(RosBag, RangesOfEqualStampBecomeBeamsOfOneEntry) {
  const auto range = [](std::uint32_t sec, float value) {
    auto message = stamped<ros1::Range>(rosTime(sec));
    message.min_range = 0.5F;
    message.max_range = 50.0F;
    message.range = value;
    return message;
  };
  auto second_beam = bagTopic("/r1", TopicRole::dvl_beams);
  second_beam.T_robot_sensor.position.x() = 9.0;
  const auto bag = makeBag([&](rosbag::Bag& b) {
    b.write("/r1", rosTime(100), range(100, 11.0F));
    b.write("/r0", rosTime(101), range(101, 20.0F));
    b.write("/r0", rosTime(102), range(100, 10.0F));  // arrives late
    b.write("/r1", rosTime(103), range(101, std::numeric_limits<float>::infinity()));
    b.write("/r0", rosTime(104), range(104, 51.0F));
  });
  const auto recording = importBag(bag, topicMap({bagTopic("/r0", TopicRole::dvl_beams), second_beam}));
  ASSERT_EQ(recording.samples.size(), 3U);
  const auto beams = [&](std::size_t k) {
    return std::get<DvlBeamsSample>(recording.samples[k].reading).beams;
  };
  ASSERT_EQ(beams(0).size(), 2U);
  EXPECT_EQ(beams(0)[0].range_m, 10.0);
  EXPECT_EQ(beams(0)[1].range_m, 11.0);
  EXPECT_EQ(beams(0)[1].T_robot_beam.position.x(), 9.0);
  EXPECT_EQ(beams(1)[0].range_m, 20.0);
  EXPECT_FALSE(beams(1)[1].range_m) << "infinite: no echo";
  EXPECT_FALSE(beams(2)[0].range_m || beams(2)[1].range_m) << "out of its limits, and never sent";
}

BagTopic cameraTopic(int width, int height) {
  BagTopic topic = bagTopic("/cam", TopicRole::camera);
  topic.intrinsics = recordedCamera({width, height, 10, 11, 2, 1});
  return topic;
}

/// 4 x 3, rows of `step` bytes: byte b of row r is 16 r + b.
ros1::Image image(const std::string& encoding, std::uint32_t channels, std::uint32_t padding) {
  auto message = stamped<ros1::Image>(rosTime(100, 5));
  message.width = 4;
  message.height = 3;
  message.encoding = encoding;
  message.step = 4 * channels + padding;
  for (unsigned r = 0; r < 3; ++r)
    for (unsigned b = 0; b < message.step; ++b)
      message.data.push_back(static_cast<unsigned char>(16 * r + b));
  return message;
}

TEST(RosBag, ImagesBecomePngOfTheSamePixels) {
  const auto pixels = [&](const ros1::Image& message) {
    const auto bag = bagOf("/cam", message);
    const auto folder = bag.parent_path() / "images";
    const auto recording = importBag(bag, topicMap({cameraTopic(4, 3)}), {.image_folder = folder});
    const auto sample = onlyReading<ImageSample>(recording, labels::kCamera);
    EXPECT_EQ(sample.file, "CAMERA_0000000100.000000005.png");
    return cv::imread((folder / sample.file).string(), cv::IMREAD_UNCHANGED);
  };
  const cv::Mat mono = pixels(image("mono8", 1, 2));
  ASSERT_EQ(mono.type(), CV_8UC1);
  EXPECT_EQ(mono.at<unsigned char>(2, 3), 16 * 2 + 3);
  const cv::Mat bgr = pixels(image("bgr8", 3, 0));
  EXPECT_EQ(bgr.at<cv::Vec3b>(1, 2), cv::Vec3b(16 + 6, 16 + 7, 16 + 8));
  const cv::Mat rgb = pixels(image("rgb8", 3, 1));
  EXPECT_EQ(rgb.at<cv::Vec3b>(1, 2), cv::Vec3b(16 + 8, 16 + 7, 16 + 6));
}

/// A plain red scene seen through each Bayer pattern must come out red.
TEST(RosBag, BayerPatternsAreNamedByTheirFirstRow) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"})
    for (const unsigned bytes : {1U, 2U}) {
      auto message = stamped<ros1::Image>(rosTime(100));
      message.width = message.height = 8;
      message.step = 8 * bytes;
      message.encoding = "bayer_" + pattern + std::to_string(8 * bytes);
      for (unsigned r = 0; r < 8; ++r)
        for (unsigned c = 0; c < 8; ++c)
          message.data.insert(message.data.end(), bytes, pattern[2 * (r % 2) + c % 2] == 'r' ? 200 : 0);
      const auto bag = bagOf("/cam", message);
      const auto folder = bag.parent_path() / "images";
      importBag(bag, topicMap({cameraTopic(8, 8)}), {.image_folder = folder});
      const cv::Mat bgr =
          cv::imread((folder / "CAMERA_0000000100.000000000.png").string(), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(bgr.type(), bytes == 1 ? CV_8UC3 : CV_16UC3);
      if (bytes == 1)
        EXPECT_EQ(bgr.at<cv::Vec3b>(4, 4), cv::Vec3b(0, 0, 200)) << pattern;
      else
        EXPECT_EQ(bgr.at<cv::Vec3w>(4, 4), cv::Vec3w(0, 0, 200 * 257)) << pattern;
    }
}

TEST(RosBag, CompressedImagesAreKeptAsTheyAre) {
  for (const std::string extension : {".png", ".jpg"}) {
    std::vector<unsigned char> bytes;
    cv::imencode(extension, cv::Mat(3, 4, CV_8UC1, cv::Scalar(77)), bytes);
    auto message = stamped<ros1::CompressedImage>(rosTime(100));
    message.data.assign(bytes.begin(), bytes.end());
    const auto bag = bagOf("/cam", message);
    const auto folder = bag.parent_path() / "images";
    const auto recording = importBag(bag, topicMap({cameraTopic(4, 3)}), {.image_folder = folder});
    const auto sample = onlyReading<ImageSample>(recording, labels::kCamera);
    EXPECT_EQ(sample.file, "CAMERA_0000000100.000000000" + extension);
    EXPECT_EQ(readTextFile(folder / sample.file), std::string(bytes.begin(), bytes.end()));
    EXPECT_EQ(vehicleOf(recording).camera->model.width_px, 4) << "the vehicle file is whole";
  }
}

TEST(RosBag, OrderOfStampsNotOfArrivalWithinTheWindow) {
  const auto bag = makeBag([](rosbag::Bag& b) {
    unsigned received = 200;
    for (const unsigned stamp : {100U, 103U, 104U, 108U}) {
      b.write("/imu", rosTime(received++), test::imuMessage(rosTime(stamp)));
      b.write("/pressure", rosTime(received++), pressureMessage(rosTime(stamp - 2), 2e5));
    }
  });
  const auto map = topicMap({bagTopic("/imu", TopicRole::ins), bagTopic("/pressure", TopicRole::depth)});
  const auto recording = importBag(bag, map);
  std::vector<double> seconds;
  for (const Sample& s : recording.samples) seconds.push_back(toUnixSeconds(s.time));
  EXPECT_EQ(seconds, (std::vector<double>{98, 100, 101, 102, 103, 104, 106, 108}));
  EXPECT_THROW(importBag(bag, map, {.reorder_window_s = 0.5, .image_folder = {}}), Error)
      << "98 comes after 100 is gone";
}

TEST(RosBag, RefusesBadMessages) {
  const auto imu_map = topicMap({bagTopic("/imu", TopicRole::ins)});
  const auto without_stamp = makeBag([](rosbag::Bag& b) {
    b.write("/imu", rosTime(1), test::imuMessage(rosTime(1)));
    b.write("/imu", rosTime(2), test::imuMessage(ros::Time()));
  });
  expectError(without_stamp, imu_map, "/imu, message 2: has no time stamp");
  auto imu = test::imuMessage(rosTime(1));
  imu.angular_velocity.y = kNan;
  expectError(bagOf("/imu", imu), imu_map, "angular_velocity is not finite");
  imu = test::imuMessage(rosTime(1));
  imu.orientation.w = 0.5;
  expectError(bagOf("/imu", imu), imu_map, "not a unit quaternion");
  auto pressure = stamped<ros1::FluidPressure>(rosTime(1));
  pressure.fluid_pressure = kNan;
  expectError(bagOf("/p", pressure), topicMap({bagTopic("/p", TopicRole::depth)}), "not finite");
  auto range = stamped<ros1::Range>(rosTime(1));
  range.range = std::numeric_limits<float>::quiet_NaN();
  expectError(bagOf("/r", range), topicMap({bagTopic("/r", TopicRole::dvl_beams)}), "not a number");

  const auto camera = topicMap({cameraTopic(4, 3)});
  expectError(bagOf("/cam", image("nv21", 2, 0)), camera, "encoding `nv21`");
  auto small = image("mono8", 1, 0);
  small.data.pop_back();
  expectError(bagOf("/cam", small), camera, "does not fit");
  expectError(bagOf("/cam", image("mono8", 1, 0)), topicMap({cameraTopic(5, 3)}), "another size");
  auto compressed = stamped<ros1::CompressedImage>(rosTime(1));
  compressed.data.assign(100, 'x');
  expectError(bagOf("/cam", compressed), camera, "neither PNG nor JPEG");
  EXPECT_THROW(importBag(bagOf("/cam", image("mono8", 1, 0)), camera), Error) << "no folder for images";
}

TEST(RosBag, RefusesBagsThatDoNotFitTheMap) {
  const auto bag = makeBag([](rosbag::Bag& b) {
    b.write("/imu", rosTime(1), test::imuMessage(rosTime(1)));
    b.write("/pressure", rosTime(1), stamped<ros1::FluidPressure>(rosTime(1)));
  });
  expectError(bag, topicMap({bagTopic("/imu/data", TopicRole::ins)}),
              "no such topic (topics.yaml asks for it); the bag has /imu (sensor_msgs/Imu), /pressure "
              "(sensor_msgs/FluidPressure)");
  expectError(bag, topicMap({bagTopic("/pressure", TopicRole::ins)}),
              "is a sensor_msgs/FluidPressure; INS is made of sensor_msgs/Imu");
  expectError(bag, topicMap({bagTopic("/imu", TopicRole::dvl)}),
              "DVL is made of nav_msgs/Odometry or geometry_msgs/TwistWithCovarianceStamped");
  expectError(makeBag([](rosbag::Bag&) {}), topicMap({bagTopic("/imu", TopicRole::ins)}),
              "the bag has nothing");
  const auto folder = test::scratchFolder();
  expectError(folder / "none.bag", topicMap({}), "cannot be read");
  expectError(folder, topicMap({}), "cannot be read");
  writeTextFile(folder / "text.bag", "hello\n");
  expectError(folder / "text.bag", topicMap({}), "is not a ROS 1 bag of version 2.0");
}

TEST(RosBag, StreamsWithoutKeepingSamples) {
  const auto bag = makeBag([](rosbag::Bag& b) {
    for (unsigned k = 1; k <= 50; ++k) b.write("/imu", rosTime(k), test::imuMessage(rosTime(k)));
  });
  std::size_t count = 0;
  const auto recording =
      streamBag(bag, topicMap({bagTopic("/imu", TopicRole::ins)}), [&](Sample&&) { ++count; });
  EXPECT_EQ(count, 50U);
  EXPECT_TRUE(recording.samples.empty());
  EXPECT_EQ(recording.start, fromUnixSeconds(1));
}

/// A DVL's velocities, one a second, and what is imported of them.
ImportedRecording dvlOf(const std::vector<std::pair<double, double>>& velocity_and_variance) {
  return importBag(makeBag([&](rosbag::Bag& bag) {
                     std::uint32_t second = 100;
                     for (const auto& [velocity, variance] : velocity_and_variance) {
                       auto twist = stamped<ros1::TwistWithCovarianceStamped>(rosTime(second++));
                       twist.twist.twist.linear.x = velocity;
                       twist.twist.covariance[0] = twist.twist.covariance[7] = variance;
                       bag.write("/dvl", twist.header.stamp, twist);
                     }
                   }),
                   topicMap({bagTopic("/dvl", TopicRole::dvl)}));
}

// As drivers say it: NaN, a variance of -1 or of a million, PD0's -32768 mm/s.
TEST(RosBag, WhatHasNoBottomLockIsAbsent) {
  const auto recording = dvlOf({{0.5, 1e-4}, {kNan, 1e-4}, {0, -1}, {0, 1e6}, {-32.768, 1e-4}, {0.6, 1e-4}});
  ASSERT_EQ(recording.samples.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(std::get<DvlSample>(recording.samples[i].reading).velocity_dvl.has_value(), i == 0 || i == 5)
        << i;
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_EQ(recording.remarks[0], "/dvl: 4 of 6 messages say that there is no bottom lock");
}

// In metres, decimetres, centimetres or millimetres; by any one of the variances; by one that nobody moves
// with.
TEST(RosBag, NoBottomLockIsSaidInManyWays) {
  const auto lockOf = [](double x, double z, double variance_xy, double variance_z) {
    const auto recording =
        importBag(makeBag([&](rosbag::Bag& bag) {
                    for (const bool tried : {false, true}) {
                      auto twist = stamped<ros1::TwistWithCovarianceStamped>(rosTime(tried ? 101 : 100));
                      twist.twist.twist.linear.x = tried ? x : 0.5;
                      twist.twist.twist.linear.z = tried ? z : 0;
                      twist.twist.covariance[0] = twist.twist.covariance[7] = tried ? variance_xy : 1e-4;
                      twist.twist.covariance[14] = tried ? variance_z : 1e-4;
                      bag.write("/dvl", twist.header.stamp, twist);
                    }
                  }),
                  topicMap({bagTopic("/dvl", TopicRole::dvl)}));
    return std::get<DvlSample>(recording.samples.at(1).reading).velocity_dvl.has_value();
  };
  for (const double none : {-32768.0, -327.68, -99999.0, -99.999})
    EXPECT_FALSE(lockOf(0.1, none, 1e-4, 1e-4));
  EXPECT_FALSE(lockOf(0, 0, 1e-4, -1));
  EXPECT_FALSE(lockOf(0.1, 0, 1e-4, 1e6));
  EXPECT_FALSE(lockOf(0, 0, 100, 100));
  EXPECT_TRUE(lockOf(0, 0, 1e-4, 1e-4));  // at rest
  EXPECT_TRUE(lockOf(0.1, 0, 1e-2, 1e-2));
}

// The first message's covariance may be that of a sensor that has not settled.
TEST(RosBag, SigmasAreTheMessagesMedian) {
  const auto recording = dvlOf({{0.5, 25}, {0.5, 4e-4}, {0.5, 4e-4}, {0, -1}, {0.5, 4e-4}, {0.5, 9e-4}});
  EXPECT_NEAR(vehicleOf(recording).dvl->velocity_sigma_xy_m_s, 0.02, 1e-12);
}

/// What a driver publishes that was cut off: a sensor_msgs/Imu that ends behind its header.
struct CutImu {
  std_msgs::Header_<ros1::Allocator<void>> header;
};

}  // namespace
}  // namespace fathom

template <>
struct ros::message_traits::MD5Sum<fathom::CutImu> : ros::message_traits::MD5Sum<fathom::ros1::Imu> {
  static const char* value(const fathom::CutImu&) { return MD5Sum<fathom::ros1::Imu>::value(); }
};
template <>
struct ros::message_traits::DataType<fathom::CutImu> : ros::message_traits::DataType<fathom::ros1::Imu> {
  static const char* value(const fathom::CutImu&) { return DataType<fathom::ros1::Imu>::value(); }
};
template <>
struct ros::message_traits::Definition<fathom::CutImu> : ros::message_traits::Definition<fathom::ros1::Imu> {
  static const char* value(const fathom::CutImu&) { return Definition<fathom::ros1::Imu>::value(); }
};
template <>
struct ros::serialization::Serializer<fathom::CutImu> {
  template <class Stream, class T>
  static void allInOne(Stream& stream, T message) {
    stream.next(message.header);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

namespace fathom {
namespace {

TEST(RosBag, OneMessageCutShortIsLeftOut) {
  const auto file = makeBag([&](rosbag::Bag& bag) {
    for (std::uint32_t second = 100; second < 110; ++second) {
      if (second == 104)
        bag.write("/imu", rosTime(second), CutImu{});
      else
        bag.write("/imu", rosTime(second), test::imuMessage(rosTime(second)));
    }
  });
  const auto map = topicMap({bagTopic("/imu", TopicRole::ins)});
  const auto recording = importBag(file, map);
  EXPECT_EQ(recording.samples.size(), 9U);
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_NE(recording.remarks[0].find("/imu, message 5: is too short for a sensor_msgs/Imu"),
            std::string::npos)
      << recording.remarks[0];
  expectError(file, map, "/imu, message 5: is too short");
}

TEST(RosBag, AMessageWithoutAttitudeKeepsTheRest) {
  const auto file = makeBag([&](rosbag::Bag& bag) {
    for (std::uint32_t second = 100; second < 106; ++second) {
      auto imu = test::imuMessage(rosTime(second));
      if (second == 101) imu.orientation.w = 0;
      if (second == 102) imu.orientation.x = kNan;
      if (second == 103) imu.orientation_covariance[4] = 1e9;
      if (second == 104) imu.orientation_covariance[8] = -1;
      bag.write("/imu", imu.header.stamp, imu);
    }
  });
  const auto recording = importBag(file, topicMap({bagTopic("/imu", TopicRole::ins)}));
  ASSERT_EQ(recording.samples.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& ins = std::get<InsSample>(recording.samples[i].reading);
    EXPECT_EQ(ins.R_odom_ins.has_value(), i == 0 || i == 5) << i;
    EXPECT_TRUE(ins.angular_velocity_ins && ins.specific_force_ins) << i;
  }
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_EQ(recording.remarks[0],
            "/imu: 2 of 6 messages have no attitude: their quaternion is zero or no number");
}

TEST(RosBag, WhatIsNoPressureIsLeftOut) {
  const auto file = makeBag([&](rosbag::Bag& bag) {
    std::uint32_t second = 100;
    for (const auto& [pressure_pa, variance] :
         {std::pair(2e5, 1e4), {0.0, 1e4}, {-32768.0, 1e4}, {2e5, -1.0}, {2e5, 0.0}}) {
      auto pressure = pressureMessage(rosTime(second++), pressure_pa);
      pressure.variance = variance;
      bag.write("/p", pressure.header.stamp, pressure);
    }
  });
  const auto recording = importBag(file, topicMap({bagTopic("/p", TopicRole::depth)}));
  EXPECT_EQ(recording.samples.size(), 2U);
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_NE(recording.remarks[0].find("/p: 3 of 5 messages are left out"), std::string::npos);
}

TEST(RosBag, OneBadMessageIsLeftOut) {
  const auto file = makeBag([&](rosbag::Bag& bag) {
    for (std::uint32_t second = 100; second < 110; ++second) {
      auto imu = test::imuMessage(rosTime(second));
      if (second >= 105 && second != 109) imu.angular_velocity.x = kNan;
      bag.write("/imu", imu.header.stamp, imu);
    }
  });
  const auto map = topicMap({bagTopic("/imu", TopicRole::ins)});
  const auto recording = importBag(file, map);
  EXPECT_EQ(recording.samples.size(), 6U);
  ASSERT_EQ(recording.remarks.size(), 1U);
  const std::string& remark = recording.remarks[0];
  EXPECT_NE(
      remark.find("/imu: 4 of 10 messages are left out: /imu, message 6: angular_velocity is not finite"),
      std::string::npos)
      << remark;
  EXPECT_NE(remark.find("message 8"), std::string::npos) << "three are quoted";
  EXPECT_EQ(remark.find("message 9"), std::string::npos) << "no more";
  BagOptions strict;
  strict.strict = true;
  EXPECT_THROW(importBag(file, map, strict), Error);
}

/// Ten messages a second, whose stamps are as far off from some number on as `off_s` says.
void writeImus(rosbag::Bag& bag, const std::function<double(int)>& off_s) {
  for (int i = 0; i < 100; ++i)
    bag.write("/imu", ros::Time(1000 + 0.1 * i), test::imuMessage(ros::Time(1000 + 0.1 * i + off_s(i))));
}

// However little, and before anything has left the buffer, too.
TEST(RosBag, AClockThatStepsBackIsRefusedWhereverItDoes) {
  const auto map = topicMap({bagTopic("/imu", TopicRole::ins)});
  for (const int from : {2, 60})
    for (const double back_s : {0.3, 3.0, 4.9}) {
      const auto file =
          makeBag([&](rosbag::Bag& bag) { writeImus(bag, [&](int i) { return i < from ? 0.0 : -back_s; }); });
      expectError(file, map,
                  "/imu, message " + std::to_string(from + 1) + ": its stamp steps back by " +
                      std::to_string(back_s - 0.1).substr(0, 5) + " s; `stamps: arrival`");
    }
  const auto jitter =
      makeBag([](rosbag::Bag& bag) { writeImus(bag, [](int i) { return i % 2 == 0 ? 0.065 : -0.065; }); });
  EXPECT_EQ(importBag(jitter, map).samples.size(), 100U);
}

TEST(RosBag, OneStampOfAnotherTimeIsABadMessage) {
  const auto map = topicMap({bagTopic("/imu", TopicRole::ins), bagTopic("/pressure", TopicRole::depth)});
  for (const double off_s : {-500.0, 60.0, 1e8}) {
    const auto file = makeBag([&](rosbag::Bag& bag) {
      writeImus(bag, [&](int i) { return i == 40 ? off_s : 0.0; });
      for (int i = 0; i < 10; ++i)
        bag.write("/pressure", rosTime(1000 + i), pressureMessage(rosTime(1000 + i), 2e5));
    });
    const auto recording = importBag(file, map);
    EXPECT_EQ(recording.samples.size(), 109U);
    ASSERT_EQ(recording.remarks.size(), 1U);
    EXPECT_NE(recording.remarks[0].find("1 of 100 messages are left out: /imu, message 41: its stamp is"),
              std::string::npos)
        << recording.remarks[0];
    expectError(file, map, "/imu, message 41");
  }
  const auto set =
      makeBag([](rosbag::Bag& bag) { writeImus(bag, [](int i) { return i < 40 ? 0.0 : 60.0; }); });
  try {
    importBag(set, topicMap({map.topics[0]}));
    ADD_FAILURE() << "a clock that was set is accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/imu, message 42: the clock of its stamps was set"),
              std::string::npos)
        << error.what();
  }
}

// Not whichever topic comes next.
TEST(RosBag, TheTopicOfAnotherClockIsNamed) {
  for (const double off_s : {18.0, -18.0, 7200.0}) {
    const auto file = makeBag([&](rosbag::Bag& bag) {
      for (int i = 0; i < 30; ++i) {
        bag.write("/pressure", ros::Time(999.95 + i), pressureMessage(ros::Time(999.95 + i + off_s), 2e5));
        bag.write("/imu", rosTime(1000 + i), test::imuMessage(rosTime(1000 + i)));
      }
    });
    expectError(file, topicMap({bagTopic("/imu", TopicRole::ins), bagTopic("/pressure", TopicRole::depth)}),
                "/pressure: its stamps are " + std::to_string(std::abs(off_s)).substr(0, 6));
  }
}

/// A bag of 60 s with odometry, which is a DVL and a reference, stamped so much off.
std::filesystem::path odometryBag(const std::function<double(int)>& off_s) {
  return makeBag([&](rosbag::Bag& bag) {
    for (int i = 0; i < 60; ++i) {
      bag.write("/imu", rosTime(1000 + i), test::imuMessage(rosTime(1000 + i)));
      auto odometry = stamped<ros1::Odometry>(ros::Time(1000 + i + off_s(i)));
      odometry.pose.pose.orientation.w = 1;
      bag.write("/odom", rosTime(1000 + i), odometry);
    }
  });
}

// As those of a sensor are.
TEST(RosBag, AReferencesStampsAreChecked) {
  const auto map = topicMap({bagTopic("/imu", TopicRole::ins), bagTopic("/odom", TopicRole::reference)});
  expectError(odometryBag([](int i) { return i < 30 ? 0.0 : -3.0; }), map,
              "/odom, message 31: its stamp steps back by 2.000 s; `stamps: arrival`");
  expectError(odometryBag([](int) { return -990.0; }), map,
              "/odom: its stamps have no time in common with the sensors': they are 931.000 s before them; "
              "`stamps: arrival`");
  const auto late = importBag(odometryBag([](int) { return -20.0; }), map);
  ASSERT_EQ(late.remarks.size(), 1U);
  EXPECT_NE(late.remarks[0].find("/odom: its stamps are 20.000 s behind the sensors'"), std::string::npos)
      << late.remarks[0];
  EXPECT_EQ(late.reference.size(), 60U);
}

TEST(RosBag, AMessageOfTwoRolesIsLeftOutOnce) {
  const auto recording =
      importBag(odometryBag([](int i) { return i == 40 ? 1e6 : 0.0; }),
                topicMap({bagTopic("/odom", TopicRole::dvl), bagTopic("/odom", TopicRole::reference)}));
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_NE(recording.remarks[0].find("1 of 60 messages are left out"), std::string::npos)
      << recording.remarks[0];
}

TEST(RosBag, AQuaternionSomewhatOffUnitNormIsNormalized) {
  auto imu = test::imuMessage(rosTime(1));
  imu.orientation.w = 1.1;
  const auto recording = importBag(bagOf("/imu", imu), topicMap({bagTopic("/imu", TopicRole::ins)}));
  const auto ins = onlyReading<InsSample>(recording, "INS");
  EXPECT_TRUE(ins.R_odom_ins->isApprox(Matrix3d::Identity()));
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_NE(recording.remarks[0].find("off unit norm, up to 1.1"), std::string::npos) << recording.remarks[0];
}

// Where a driver's own stamps are of no use: that they step back, or are none.
TEST(RosBag, StampsOfArrivalAreTakenWhereTheMapSaysSo) {
  const auto file = makeBag([&](rosbag::Bag& bag) {
    for (std::uint32_t second = 0; second < 60; ++second)
      bag.write("/imu", rosTime(1000 + second), test::imuMessage(rosTime(second < 30 ? 500 + second : 0)));
  });
  auto topic = bagTopic("/imu", TopicRole::ins);
  expectError(file, topicMap({topic}), "`stamps: arrival`");
  topic.stamps = TopicStamps::arrival;
  const auto recording = importBag(file, topicMap({topic}));
  ASSERT_EQ(recording.samples.size(), 60U);
  EXPECT_EQ(recording.samples[45].time, fromUnixSeconds(1045));
}

TEST(RosBag, PosesAndTwistsWithoutCovarianceAreTaken) {
  auto twist = stamped<ros1::TwistStamped>(rosTime(100));
  twist.twist.linear.x = 0.5;
  twist.twist.linear.z = -0.02;
  auto recording = importBag(bagOf("/dvl", twist), topicMap({bagTopic("/dvl", TopicRole::dvl)}));
  EXPECT_TRUE(
      onlyReading<DvlSample>(recording, labels::kDvl).velocity_dvl->isApprox(Vector3d(0.5, 0, -0.02)));
  EXPECT_NEAR(vehicleOf(recording).dvl->velocity_sigma_xy_m_s, 0.01, 1e-12) << "generic";

  auto pose = stamped<ros1::PoseStamped>(rosTime(100));
  pose.pose.position.x = 3;
  pose.pose.position.z = -5;
  pose.pose.orientation.w = 1;
  recording = importBag(bagOf("/usbl", pose), topicMap({bagTopic("/usbl", TopicRole::usbl)}));
  EXPECT_TRUE(onlyReading<PoseSample>(recording, labels::kUsbl)
                  .T_odom_robot.mean.position.isApprox(Vector3d(3, 0, -5)));
  recording = importBag(bagOf("/depth", pose), topicMap({bagTopic("/depth", TopicRole::depth)}));
  EXPECT_NEAR(onlyReading<DepthSample>(recording, labels::kDepth).pressure_pa, 101325 + 1025 * 9.80665 * 5,
              1e-6);

  auto transform = stamped<ros1::TransformStamped>(rosTime(100));
  transform.transform.translation.x = 3;
  transform.transform.translation.z = -5;
  transform.transform.rotation.w = 1;
  const auto imu = test::imuMessage(rosTime(100));
  const BagTopic reference = bagTopic("/reference", TopicRole::reference);
  const auto referenceOf = [&](const auto& message) {
    return importBag(makeBag([&](rosbag::Bag& bag) {
                       bag.write("/imu", imu.header.stamp, imu);
                       bag.write("/reference", message.header.stamp, message);
                     }),
                     topicMap({bagTopic("/imu", TopicRole::ins), reference}))
        .reference;
  };
  for (const auto& path : {referenceOf(pose), referenceOf(transform)}) {
    ASSERT_EQ(path.size(), 1U);
    EXPECT_TRUE((path[0].T_odom_robot * reference.T_robot_sensor).position.isApprox(Vector3d(3, 0, -5)));
  }
}

/// An image of two by two pixels, of bytes as they come.
ros1::Image smallImage(const std::string& encoding, const std::vector<std::uint8_t>& bytes) {
  auto image = stamped<ros1::Image>(rosTime(100));
  image.encoding = encoding;
  image.width = image.height = 2;
  image.step = static_cast<std::uint32_t>(bytes.size() / 2);
  image.data.assign(bytes.begin(), bytes.end());
  return image;
}

cv::Mat pictureOf(const ros1::Image& image) {
  auto topic = bagTopic("/camera", TopicRole::camera);
  topic.intrinsics = RecordedCamera{};
  topic.intrinsics->model.width_px = topic.intrinsics->model.height_px = 2;
  const auto bag = bagOf("/camera", image);
  const auto folder = bag.parent_path() / "images";
  std::filesystem::create_directories(folder);
  const auto recording = importBag(bag, topicMap({topic}), {.image_folder = folder});
  const auto sample = onlyReading<ImageSample>(recording, labels::kCamera);
  const cv::Mat picture = cv::imread((folder / sample.file).string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(vehicleOf(recording).camera->bits, image.encoding.find("16") != std::string::npos ? 16 : 8);
  return picture;
}

TEST(RosBag, ImageEncodingsThatMeanTheSameAreRead) {
  EXPECT_EQ(pictureOf(smallImage("8UC1", {1, 2, 3, 4})).at<std::uint8_t>(1, 0), 3);
  EXPECT_EQ(pictureOf(smallImage("8UC3", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12})).at<cv::Vec3b>(0, 1),
            cv::Vec3b(4, 5, 6));
  const std::vector<std::uint8_t> four{1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 0, 10, 11, 12, 0};
  EXPECT_EQ(pictureOf(smallImage("bgra8", four)).at<cv::Vec3b>(0, 1), cv::Vec3b(4, 5, 6));
  EXPECT_EQ(pictureOf(smallImage("rgba8", four)).at<cv::Vec3b>(0, 1), cv::Vec3b(6, 5, 4));
  // Gray of 16 bits keeps them, in either order of bytes.
  auto deep = smallImage("mono16", {0x34, 0x12, 0, 0, 0, 0, 0xff, 0xff});
  EXPECT_EQ(pictureOf(deep).at<std::uint16_t>(0, 0), 0x1234);
  deep.is_bigendian = 1;
  EXPECT_EQ(pictureOf(deep).at<std::uint16_t>(0, 0), 0x3412);
  const std::vector<std::uint8_t> colours{1, 0, 2, 0, 3, 0, 4,  0, 5,  0, 6,  0,
                                          7, 0, 8, 0, 9, 0, 10, 0, 11, 0, 12, 1};
  for (const char* encoding : {"bgr16", "16UC3", "BGR16"})
    EXPECT_EQ(pictureOf(smallImage(encoding, colours)).at<cv::Vec3w>(1, 1), cv::Vec3w(10, 11, 268))
        << encoding;
  EXPECT_EQ(pictureOf(smallImage("rgb16", colours)).at<cv::Vec3w>(1, 1), cv::Vec3w(268, 11, 10));
  auto swapped = smallImage("rgb16", colours);
  swapped.is_bigendian = 1;
  EXPECT_EQ(pictureOf(swapped).at<cv::Vec3w>(1, 1), cv::Vec3w(12 * 256 + 1, 11 * 256, 10 * 256));
  EXPECT_EQ(pictureOf(smallImage("MONO8", {1, 2, 3, 4})).at<std::uint8_t>(1, 0), 3);
  // Of no colour (128): gray 16 is black, 235 is white (ITU-R BT.601).
  for (const auto& [encoding, bytes] :
       {std::pair("yuv422", std::vector<std::uint8_t>{128, 16, 128, 235, 128, 235, 128, 16}),
        {"yuv422_yuy2", {16, 128, 235, 128, 235, 128, 16, 128}}}) {
    const cv::Mat picture = pictureOf(smallImage(encoding, bytes));
    EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0)) << encoding;
    EXPECT_EQ(picture.at<cv::Vec3b>(0, 1), cv::Vec3b(255, 255, 255)) << encoding;
  }
}

}  // namespace
}  // namespace fathom
