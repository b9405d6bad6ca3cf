#pragma once

#include <rosbag/bag.h>

#include "core/files.h"
#include "ros_bag/import_bag.h"
#include "ros_bag/ros_messages.h"
#include "sensors/vehicle.h"
#include "support/shared_data.h"

/// ROS 1 bags made by the tests, with rosbag's own writer.
namespace fathom::test {

inline ros::Time rosTime(std::uint32_t sec, std::uint32_t nsec = 0) { return {sec, nsec}; }

template <class M>
M stamped(ros::Time stamp) {
  M message;
  message.header.stamp = stamp;
  message.header.frame_id = "frame";
  return message;
}

/// Level, at rest, gyro 0.1 0.2 0.3 rad/s.
inline ros1::Imu imuMessage(ros::Time stamp) {
  auto imu = stamped<ros1::Imu>(stamp);
  imu.orientation.w = 1.0;
  imu.angular_velocity.x = 0.1;
  imu.angular_velocity.y = 0.2;
  imu.angular_velocity.z = 0.3;
  imu.linear_acceleration.z = 9.80665;
  for (std::size_t i = 0; i < 9; i += 4) {
    imu.orientation_covariance[i] = 1e-4;
    imu.angular_velocity_covariance[i] = 4e-6;
    imu.linear_acceleration_covariance[i] = 9e-4;
  }
  return imu;
}

inline BagTopic bagTopic(const std::string& name, TopicRole role) {
  BagTopic topic;
  topic.topic = name;
  topic.as = role;
  topic.T_robot_sensor = {rotationFromYawPitchRoll(0.3, -0.2, 0.1), Vector3d(1, 2, 3)};
  return topic;
}

inline TopicMap topicMap(std::vector<BagTopic> topics) {
  TopicMap map;
  map.file = "topics.yaml";
  map.topics = std::move(topics);
  return map;
}

/// As the vehicle file says that is written beside the rawlog.
inline Vehicle vehicleOf(const ImportedRecording& recording) {
  const auto file = scratchFolder() / "vehicle.yaml";
  writeTextFile(file, recording.vehicle_yaml);
  return readVehicle(file);
}

}  // namespace fathom::test
