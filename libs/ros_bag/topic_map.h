#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/kinematics.h"
#include "recording/samples.h"

namespace fathom {

/// What a topic of a bag becomes; messageTypesOf() has the ROS 1 messages that suit each. Of
/// nav_msgs/Odometry a DVL takes the twist, a reference the pose; of a pose a depth sensor takes minus z, a
/// USBL the position; DVL_BEAMS are one topic a beam, in the order of the map; a reference of transforms
/// takes the static ones, too: of /robot/tf /robot/tf_static, where there is no such topic /tf_static.
enum class TopicRole { ins, dvl, dvl_beams, depth, usbl, camera, reference };

/// Whose time a topic's messages have: their header's, of measurement by right; or the bag's, of arrival,
/// where a driver writes no stamps or those of a clock that steps.
enum class TopicStamps { header, arrival };

struct BagTopic {
  std::string topic;
  TopicRole as = TopicRole::ins;
  TopicStamps stamps = TopicStamps::header;
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

/// As ROS names them.
const std::vector<std::string>& messageTypesOf(TopicRole role);
/// A line a role, with its message types.
std::string topicMapHelp();

/// "INS", "DVL", …
const char* roleName(TopicRole role);

}  // namespace fathom
