#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/kinematics.h"
#include "recording/samples.h"

namespace fathom {

/// What a topic of a bag becomes. Message types (ROS 1) that suit each:
///   INS        sensor_msgs/Imu
///   DVL        nav_msgs/Odometry (its twist), geometry_msgs/TwistWithCovarianceStamped, TwistStamped
///   DVL_BEAMS  sensor_msgs/Range, one topic a beam, in the order of the map
///   DEPTH      sensor_msgs/FluidPressure; geometry_msgs/PoseWithCovarianceStamped, PoseStamped (depth: minus
///              its z), nav_msgs/Odometry likewise
///   USBL       geometry_msgs/PoseWithCovarianceStamped (its position), PoseStamped
///   CAMERA     sensor_msgs/Image, sensor_msgs/CompressedImage
///   REFERENCE  nav_msgs/Odometry (its pose), geometry_msgs/PoseWithCovarianceStamped, PoseStamped,
///              TransformStamped, tf2_msgs/TFMessage (with the bag's /tf_static)
enum class TopicRole { ins, dvl, dvl_beams, depth, usbl, camera, reference };

struct BagTopic {
  std::string topic;
  TopicRole as = TopicRole::ins;
  Pose T_robot_sensor;
  // INS: which fields are used, and whose attitude `orientation` is.
  bool use_orientation = true, use_rate = true, use_acceleration = true;
  bool orientation_is_robot = false;         ///< else the sensor's own, as ROS defines it
  std::optional<RecordedCamera> intrinsics;  ///< CAMERA only
  /// REFERENCE from transforms: the frame whose path it is (where the pose says the sensor's is), and in
  /// which. Empty: of the only transform that moves.
  std::string child_frame, frame;
};

/// Which topics of a bag become what, see config/husky_topics.yaml.
struct TopicMap {
  std::string file;  ///< for error messages
  std::string description;
  double gravity_m_s2 = kStandardGravity_m_s2;
  std::vector<BagTopic> topics;
};

/// Strict, see core/yaml.h. Every role at most once, except DVL_BEAMS. Throws Error.
TopicMap readTopicMap(const std::filesystem::path& file);

/// "INS", "DVL", …
const char* roleName(TopicRole role);

}  // namespace fathom
