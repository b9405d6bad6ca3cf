#include <yaml-cpp/yaml.h>

#include "core/text.h"
#include "panel/panel_map.h"

namespace fathom {
namespace {

/// Degrees, to 1e-12 of a radian: 30, not 29.999999999999996.
std::string inDegrees(double angle_rad) { return shortest(std::round(degrees(angle_rad) * 1e11) / 1e11); }

using Entry = std::pair<const char*, std::string>;

void writeFlow(YAML::Emitter& out, std::initializer_list<Entry> entries) {
  out << YAML::Flow << YAML::BeginMap;
  for (const auto& [key, value] : entries) out << YAML::Key << key << YAML::Value << value;
  out << YAML::EndMap;
}

void writePose(YAML::Emitter& out, const Pose& T) {
  const Vector3d ypr = yawPitchRollFromRotation(T.rotation);
  writeFlow(out, {{"x", shortest(T.position.x())},
                  {"y", shortest(T.position.y())},
                  {"z", shortest(T.position.z())},
                  {"yaw_deg", inDegrees(ypr[0])},
                  {"pitch_deg", inDegrees(ypr[1])},
                  {"roll_deg", inDegrees(ypr[2])}});
}

void writeMarker(YAML::Emitter& out, const Marker& m) {
  writeFlow(out, {{"family", m.family},
                  {"id", std::to_string(m.id)},
                  {"size_m", shortest(m.size_m)},
                  {"x", shortest(m.T_panel_marker.position.x())},
                  {"y", shortest(m.T_panel_marker.position.y())},
                  {"z", shortest(m.T_panel_marker.position.z())},
                  {"rotation_deg", inDegrees(yawPitchRollFromRotation(m.T_panel_marker.rotation)[0])}});
}

void writeHandle(YAML::Emitter& out, const Handle& h) {
  out << YAML::Flow << YAML::BeginMap;
  const auto write = [&out](const char* key, const std::string& value) {
    out << YAML::Key << key << YAML::Value << value;
  };
  write("id", h.id);
  write("kind", std::string(nameOf(h.kind)));
  write("x", shortest(h.position_panel.x()));
  write("y", shortest(h.position_panel.y()));
  write("z", shortest(h.position_panel.z()));
  write("radius_m", shortest(h.radius_m));
  write("length_m", shortest(h.length_m));
  out << YAML::Key << "range_deg" << YAML::Value << YAML::Flow << YAML::BeginSeq
      << inDegrees(h.smallest_angle_rad) << inDegrees(h.largest_angle_rad) << YAML::EndSeq;
  write("angle_deg", inDegrees(h.angle_rad));
  out << YAML::EndMap;
}

}  // namespace

std::string formatPanelMap(const PanelMap& map) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "panel" << YAML::Value << map.name;
  out << YAML::Key << "pose" << YAML::Value;
  writePose(out, map.T_odom_panel);
  out << YAML::Key << "pose_sigma" << YAML::Value;
  writeFlow(out,
            {{"position_m", shortest(map.position_sigma_m)}, {"angle_deg", inDegrees(map.angle_sigma_rad)}});
  out << YAML::Key << "mesh" << YAML::Value << map.mesh_file;
  out << YAML::Key << "white_albedo" << YAML::Value << shortest(map.white_albedo);
  out << YAML::Key << "black_albedo" << YAML::Value << shortest(map.black_albedo);
  if (const MarkerLook look = map.look(); look != MarkerLook{}) {
    out << YAML::Key << "marker_look" << YAML::Value;
    writeFlow(out, {{"border_cells", std::to_string(look.border_width)},
                    {"white_on_black", look.white_on_black ? "true" : "false"},
                    {"saddle_corners", look.saddle_corners ? "true" : "false"}});
  }
  out << YAML::Key << "markers" << YAML::Value << YAML::BeginSeq;
  for (const Marker& marker : map.markers) writeMarker(out, marker);
  out << YAML::EndSeq << YAML::Key << "handles" << YAML::Value << YAML::BeginSeq;
  for (const Handle& handle : map.handles) writeHandle(out, handle);
  out << YAML::EndSeq << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace fathom
