#include "panel/panel_map.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "core/files.h"
#include "core/yaml.h"
#include "panel/face.h"
#include "panel/marker_family.h"
#include "panel/mesh.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kAngleSlack_rad = 1e-9;  // degrees and back
constexpr double kBehind_m = 1e-6;        // a mesh has floats

bool inRange(const Handle& handle, double angle_rad) {
  return angle_rad >= handle.smallest_angle_rad - kAngleSlack_rad &&
         angle_rad <= handle.largest_angle_rad + kAngleSlack_rad;
}

std::string rangeText(const Handle& handle) {
  char text[80];
  std::snprintf(text, sizeof text, "%.6g to %.6g deg", degrees(handle.smallest_angle_rad),
                degrees(handle.largest_angle_rad));
  return text;
}

// ---- reading

/// Of all markers of the panel.
MarkerLook readLook(const YamlMap& y) {
  MarkerLook look;
  if (!y.has("marker_look")) return look;
  const YamlMap given = y.map("marker_look");
  if (given.has("border_cells")) look.border_width = given.integer("border_cells");
  if (look.border_width != 1 && look.border_width != 2) throw given.error("border_cells", "must be 1 or 2");
  if (given.has("white_on_black")) look.white_on_black = given.flag("white_on_black");
  if (given.has("saddle_corners")) look.saddle_corners = given.flag("saddle_corners");
  return look;
}

Marker readMarker(const YamlMap& y, const MarkerLook& look) {
  Marker m;
  m.family = y.text("family");
  if (!isMarkerFamily(m.family))
    throw y.error("family",
                  "no such marker family: `" + m.family + "`; there are DICT_ARUCO_ORIGINAL, tag36h11, …");
  m.look = look;
  if (look.border_width != 1 && !hasPlainBorder(m.family))
    throw y.error("family", m.family + " has no plain border that could be two cells wide (marker_look)");
  m.id = y.integer("id");
  const int count = markerCount(m.family);
  if (m.id < 0 || m.id >= count)
    throw y.error("id",
                  m.family + " has ids 0 to " + std::to_string(count - 1) + ", not " + std::to_string(m.id));
  m.size_m = y.positive("size_m");
  m.T_panel_marker = {rotationFromYawPitchRoll(radians(y.number("rotation_deg")), 0, 0),
                      Vector3d(y.number("x"), y.number("y"), y.number("z"))};
  return m;
}

HandleKind readKind(const YamlMap& y) {
  const std::string kind = y.text("kind");
  for (const auto known : {HandleKind::lever, HandleKind::valve, HandleKind::wheel})
    if (kind == nameOf(known)) return known;
  throw y.error("kind", "must be lever, valve or wheel, not `" + kind + "`");
}

Handle readHandle(const YamlMap& y) {
  Handle h;
  h.id = y.text("id");
  h.kind = readKind(y);
  h.position_panel = {y.number("x"), y.number("y"), y.number("z")};
  h.radius_m = y.positive("radius_m");
  h.length_m = y.positive("length_m");
  const auto range_deg = y.numbers("range_deg");
  if (range_deg.size() != 2) throw y.error("range_deg", "must be [smallest, largest]");
  if (range_deg[0] > range_deg[1]) throw y.error("range_deg", "is reversed: the smallest angle comes first");
  h.smallest_angle_rad = radians(range_deg[0]);
  h.largest_angle_rad = radians(range_deg[1]);
  h.angle_rad = radians(y.number("angle_deg"));
  if (!inRange(h, h.angle_rad)) throw y.error("angle_deg", "is outside range_deg, " + rangeText(h));
  return h;
}

/// A list that may be absent.
std::vector<YamlMap> entries(const YamlMap& y, const std::string& key) {
  return y.has(key) ? y.maps(key) : std::vector<YamlMap>{};
}

void readAlbedos(const YamlMap& y, PanelMap& map) {
  y.read("white_albedo", map.white_albedo);
  y.read("black_albedo", map.black_albedo);
  if (map.white_albedo > 1.0) throw y.error("white_albedo", "must be at most 1");
  if (map.black_albedo < 0.0) throw y.error("black_albedo", "must not be negative");
  if (map.black_albedo >= map.white_albedo)
    throw y.error(y.has("black_albedo") ? "black_albedo" : "white_albedo", "black must be darker than white");
}

void readMeshOf(const fs::path& file, const YamlMap& y, PanelMap& map) {
  map.mesh_file = y.text("mesh");
  const fs::path mesh_file = file.parent_path() / map.mesh_file;
  if (!isFile(mesh_file)) throw y.error("mesh", "there is no file " + mesh_file.string());
  std::set<std::string> drawn_by_state;
  for (const Handle& handle : map.handles) drawn_by_state.insert("handle_" + handle.id);
  Mesh mesh = readMesh(mesh_file, drawn_by_state);
  map.body = std::move(mesh.surface);
  map.materials = std::move(mesh.materials);
  map.components = mesh.components;
}

// ---- checks of the whole

void checkOnFace(const YamlMap& y, const Marker& marker, const Surface& body) {
  for (const Vector3d& corner : patternCorners_panel(marker)) {
    const auto face_z = faceHeight_m(body, corner);
    char where[80];
    std::snprintf(where, sizeof where, "x %.4g, y %.4g, z %.4g m", corner.x(), corner.y(), corner.z());
    if (!face_z)
      throw y.error("", nameOf(marker) +
                            " does not lie on the face: no part of the mesh that looks forward is within 1 "
                            "cm of its corner at " +
                            where);
    if (corner.z() < *face_z - kBehind_m) {
      char why[80];
      std::snprintf(why, sizeof why, ", behind the face, whose z is %.4g m there", *face_z);
      throw y.error("z", nameOf(marker) + " has a corner at " + where + why);
    }
  }
}

void checkMarkers(const std::vector<YamlMap>& listed, const PanelMap& map) {
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const Marker& marker = map.markers[i];
    for (std::size_t j = 0; j < i; ++j) {
      const Marker& other = map.markers[j];
      if (marker.family == other.family && marker.id == other.id)
        throw listed[i].error("id", nameOf(marker) + " is on the panel twice");
      if (lookAlike(marker, other))
        throw listed[i].error("id", nameOf(marker) + " looks the same as " + nameOf(other));
      if (overlap(patternCorners_panel(marker), patternCorners_panel(other)))
        throw listed[i].error("", nameOf(marker) + " overlaps " + nameOf(other));
    }
    checkOnFace(listed[i], marker, map.body);
  }
}

void checkHandles(const std::vector<YamlMap>& listed, const std::vector<Handle>& handles) {
  for (std::size_t i = 0; i < handles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (handles[i].id == handles[j].id)
        throw listed[i].error("id", "there are two handles `" + handles[i].id + "`");
}

}  // namespace

void PanelMap::turnHandle(std::string_view id, double angle_rad) {
  const auto handle =
      std::find_if(handles.begin(), handles.end(), [&](const Handle& h) { return h.id == id; });
  if (handle == handles.end()) throw std::invalid_argument("no such handle: `" + std::string(id) + "`");
  if (!std::isfinite(angle_rad) || !inRange(*handle, angle_rad))
    throw std::invalid_argument("handle " + handle->id + " turns from " + rangeText(*handle));
  handle->angle_rad = angle_rad;
}

void PanelMap::setExtent() {
  half_extent_m.setZero();
  const auto reach = [&](const Vector3d& point) {
    half_extent_m = half_extent_m.cwiseMax(point.head<2>().cwiseAbs());
  };
  double back_m = std::numeric_limits<double>::infinity(), front_m = -back_m;
  for (const Marker& marker : markers)
    for (const Vector3d& corner : marker.corners_panel()) {
      reach(corner);
      back_m = std::min(back_m, corner.z());
      front_m = std::max(front_m, corner.z());
    }
  for (const Surface::Vertex& vertex : body.vertices) {
    const Vector3d point = vertex.position.cast<double>();
    const bool is_of_face =
        point.z() >= back_m - kMarkerDistance_m && point.z() <= front_m + kMarkerDistance_m;
    if (markers.empty() || is_of_face) reach(point);
  }
  for (Marker& marker : markers) marker.panel_half_m = half_extent_m;
}

Eigen::Vector2d PanelMap::reach_m() const {
  Eigen::Vector2d furthest = half_extent_m;
  for (const Surface::Vertex& vertex : body.vertices)
    furthest = furthest.cwiseMax(vertex.position.head<2>().cast<double>().cwiseAbs());
  return furthest;
}

PanelMap readPanelMap(const fs::path& file) {
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  PanelMap map;
  map.name = y.text("panel");
  map.T_odom_panel = y.pose("pose");
  const YamlMap sigma = y.map("pose_sigma");
  map.position_sigma_m = sigma.notNegative("position_m");
  map.angle_sigma_rad = radians(sigma.notNegative("angle_deg"));
  readAlbedos(y, map);
  const MarkerLook look = readLook(y);
  const auto markers = entries(y, "markers"), handles = entries(y, "handles");
  for (const YamlMap& marker : markers) map.markers.push_back(readMarker(marker, look));
  for (const YamlMap& handle : handles) map.handles.push_back(readHandle(handle));
  checkHandles(handles, map.handles);
  y.text("mesh");
  yaml.rejectUnknownKeys();
  readMeshOf(file, y, map);
  checkMarkers(markers, map);
  map.setExtent();
  return map;
}

}  // namespace fathom
