#include "ros_bag/bag_vehicle.h"

#include <cstdio>
#include <sstream>

#include "recording/imported.h"

namespace fathom {
namespace {

/// "key: value  # from where": the bag's own covariance, else a generic value, and it says so.
std::string sigmaLine(const char* key, std::optional<double> from_bag, double generic) {
  char line[160];
  std::snprintf(line, sizeof line, "  %s: %.4g   # %s\n", key, from_bag.value_or(generic),
                from_bag ? "the messages' covariance, their median" : "generic: the bag does not say");
  return line;
}

std::string poseLine(const Pose& pose) { return "  pose: " + yamlPose(pose) + "\n"; }

std::string rateLine(const MessagePace& pace) {
  char line[80];
  std::snprintf(line, sizeof line, "  rate_hz: %.4g   # mean over the bag\n", pace.rate_hz());
  return line;
}

std::string insSection(const MessagePace& pace, const MessageSigmas& sigmas) {
  std::string text = "ins:\n" + rateLine(pace) + sigmaLine("gyro_sigma_rad_s", sigmas.gyro.typical(), 0.001) +
                     sigmaLine("accelerometer_sigma_m_s2", sigmas.accelerometer.typical(), 0.01) +
                     sigmaLine("gyro_bias_sigma_rad_s", {}, 0.001) +
                     sigmaLine("accelerometer_bias_sigma_m_s2", {}, 0.05) +
                     sigmaLine("bias_time_constant_s", {}, 300);
  if (const auto attitude = sigmas.attitude.typical())
    text += sigmaLine("attitude_sigma_deg", degrees(*attitude), 1.0);
  return text;
}

std::string dvlSection(const MessagePace& pace, const MessageSigmas& sigmas) {
  return "dvl:\n" + rateLine(pace) + "  assumed_sound_speed_m_s: 1500   # generic\n" +
         sigmaLine("beam_sigma_m_s", {}, 0.007) +
         sigmaLine("velocity_sigma_xy_m_s", sigmas.velocity_xy.typical(), 0.01) +
         sigmaLine("velocity_sigma_z_m_s", sigmas.velocity_z.typical(), 0.01) +
         sigmaLine("range_sigma_m", {}, 0.015) +
         "  beam_angle_deg: 30   # generic\n"
         "  beam_azimuths_deg: [0, 90, 180, 270]   # generic; beams in the recording carry their own poses\n";
}

std::string depthSection(const MessagePace& pace, const MessageSigmas& sigmas) {
  return "depth:\n" + rateLine(pace) + sigmaLine("pressure_sigma_pa", sigmas.pressure.typical(), 100) +
         sigmaLine("pressure_offset_sigma_pa", {}, 100) +
         "  atmospheric_pressure_pa: 101325   # standard atmosphere\n" +
         sigmaLine("water_density_kg_m3", {}, 1025);
}

/// Empty where vehicle files have none for it. The mounting is left to the caller.
std::string sectionOf(const BagTopic& topic, const MessagePace& pace, const MessageSigmas& sigmas) {
  switch (topic.as) {
    case TopicRole::ins:
      return insSection(pace, sigmas);
    case TopicRole::dvl:
      return dvlSection(pace, sigmas);
    case TopicRole::depth:
      return depthSection(pace, sigmas);
    case TopicRole::usbl:
      return "usbl:\n" + rateLine(pace) + sigmaLine("position_sigma_m", sigmas.position.typical(), 0.5);
    case TopicRole::camera:
      return "camera:\n" + rateLine(pace) + cameraLines(topic.intrinsics->model, 0.15, sigmas.image_bits);
    case TopicRole::dvl_beams:
    case TopicRole::reference:
      break;
  }
  return "";
}

}  // namespace

std::string vehicleYaml(const TopicMap& map, const std::map<TopicRole, MessagePace>& paces,
                        const MessageSigmas& sigmas) {
  std::ostringstream yaml;
  yaml << "# From a ROS bag. Sigmas are the messages' own covariances where they are given.\n"
       << "gravity_m_s2: " << map.gravity_m_s2 << '\n';
  bool has_beams = false;
  for (const BagTopic& topic : map.topics) {
    const auto found = paces.find(topic.as);
    if (found == paces.end() || found->second.count == 0) continue;
    has_beams = has_beams || topic.as == TopicRole::dvl_beams;
    if (const std::string section = sectionOf(topic, found->second, sigmas); !section.empty())
      yaml << section << poseLine(topic.T_robot_sensor);
  }
  if (has_beams && !paces.contains(TopicRole::dvl))
    yaml << "# The recording has DVL_BEAMS, but no DVL: section dvl is left to the engineer.\n";
  return yaml.str();
}

}  // namespace fathom
