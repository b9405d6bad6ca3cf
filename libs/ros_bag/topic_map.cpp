#include "ros_bag/topic_map.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "core/text.h"
#include "core/yaml.h"
#include "sensors/vehicle.h"

namespace fathom {
namespace {

constexpr std::array<std::pair<const char*, TopicRole>, 7> kRoles{{{"INS", TopicRole::ins},
                                                                   {"DVL", TopicRole::dvl},
                                                                   {"DVL_BEAMS", TopicRole::dvl_beams},
                                                                   {"DEPTH", TopicRole::depth},
                                                                   {"USBL", TopicRole::usbl},
                                                                   {"CAMERA", TopicRole::camera},
                                                                   {"REFERENCE", TopicRole::reference}}};

TopicRole readRole(const YamlMap& y) {
  const std::string name = y.text("as");
  const auto found =
      std::find_if(kRoles.begin(), kRoles.end(), [&](const auto& r) { return name == r.first; });
  if (found != kRoles.end()) return found->second;
  throw y.error("as", "must be INS, DVL, DVL_BEAMS, DEPTH, USBL, CAMERA or REFERENCE, not `" + name + "`");
}

void readInsFields(const YamlMap& y, BagTopic& topic) {
  if (y.has("use")) {
    const auto used = y.texts("use");
    for (const std::string& name : used)
      if (name != "orientation" && name != "rate" && name != "acceleration")
        throw y.error("use", "knows orientation, rate and acceleration, not `" + name + "`");
    const auto uses = [&](const char* name) {
      return std::find(used.begin(), used.end(), name) != used.end();
    };
    topic.use_orientation = uses("orientation");
    topic.use_rate = uses("rate");
    topic.use_acceleration = uses("acceleration");
  }
  if (y.has("orientation_of")) {
    const std::string whose = y.text("orientation_of");
    if (whose != "sensor" && whose != "robot") throw y.error("orientation_of", "must be sensor or robot");
    topic.orientation_is_robot = whose == "robot";
  }
}

RecordedCamera readIntrinsics(const YamlMap& y) {
  const int width_px = y.integer("width_px"), height_px = y.integer("height_px");
  if (width_px <= 0 || height_px <= 0) throw y.error("width_px", "image size must be greater than zero");
  CameraModel camera{width_px,          height_px,        y.positive("fx_px"), y.positive("fy_px"),
                     y.number("cx_px"), y.number("cy_px")};
  readDistortion(y.map("distortion"), camera);
  return recordedCamera(camera);
}

BagTopic readTopic(const YamlMap& y) {
  BagTopic topic;
  topic.topic = y.text("topic");
  topic.as = readRole(y);
  if (y.has("stamps")) {
    const std::string whose = y.text("stamps");
    if (whose != "header" && whose != "arrival") throw y.error("stamps", "must be header or arrival");
    topic.stamps = whose == "header" ? TopicStamps::header : TopicStamps::arrival;
  }
  topic.T_robot_sensor = y.pose("pose");
  if (topic.as == TopicRole::ins) readInsFields(y, topic);
  if (topic.as == TopicRole::reference && y.has("child_frame"))
    topic.child_frame = y.text("child_frame"), topic.frame = y.text("frame");
  if (topic.as == TopicRole::camera) topic.intrinsics = readIntrinsics(y.map("intrinsics"));
  return topic;
}

}  // namespace

const std::vector<std::string>& messageTypesOf(TopicRole role) {
  static const std::map<TopicRole, std::vector<std::string>> kTypes{
      {TopicRole::ins, {"sensor_msgs/Imu"}},
      {TopicRole::dvl,
       {"nav_msgs/Odometry", "geometry_msgs/TwistWithCovarianceStamped", "geometry_msgs/TwistStamped"}},
      {TopicRole::dvl_beams, {"sensor_msgs/Range"}},
      {TopicRole::depth,
       {"sensor_msgs/FluidPressure", "geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/PoseStamped",
        "nav_msgs/Odometry"}},
      {TopicRole::usbl, {"geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/PoseStamped"}},
      {TopicRole::camera, {"sensor_msgs/Image", "sensor_msgs/CompressedImage"}},
      {TopicRole::reference,
       {"nav_msgs/Odometry", "geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/PoseStamped",
        "geometry_msgs/TransformStamped", "tf2_msgs/TFMessage", "tf/tfMessage"}}};
  return kTypes.at(role);
}

std::string topicMapHelp() {
  std::string text;
  for (const auto& [name, role] : kRoles) {
    std::string types;
    for (const std::string& type : messageTypesOf(role)) types += (types.empty() ? "" : ", ") + type;
    text += print("  %-10s ", name) + types + "\n";
  }
  return text;
}

const char* roleName(TopicRole role) {
  return std::find_if(kRoles.begin(), kRoles.end(), [&](const auto& r) { return role == r.second; })->first;
}

TopicMap readTopicMap(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  TopicMap map;
  map.file = file.string();
  yaml.root().read("description", map.description);
  if (yaml.root().has("gravity_m_s2")) map.gravity_m_s2 = yaml.root().positive("gravity_m_s2");
  for (const YamlMap& y : yaml.root().maps("topics")) {
    BagTopic topic = readTopic(y);
    const bool taken = std::any_of(map.topics.begin(), map.topics.end(),
                                   [&](const BagTopic& other) { return other.as == topic.as; });
    if (taken && topic.as != TopicRole::dvl_beams)
      throw y.error("as", std::string(roleName(topic.as)) + " is taken by another topic already");
    map.topics.push_back(std::move(topic));
  }
  yaml.rejectUnknownKeys();
  if (map.topics.empty()) throw Error(map.file, "topics", "must not be empty");
  return map;
}

}  // namespace fathom
