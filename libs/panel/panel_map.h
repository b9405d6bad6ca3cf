#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"
#include "panel/surface.h"

/// The knowledge base: what stands on the sea floor, and in which state its handles are. See
/// maps/dexrov/panel.yaml. Panel frame: centre of the front face; x right, y up, z out of the face.
namespace fathom {

/// A planar square fiducial on the face.
struct Marker {
  std::string family;  ///< see marker_family.h
  int id = 0;
  double size_m = 0;  ///< side of the black border square
  Pose T_panel_marker;

  /// Top-left, top-right, bottom-right, bottom-left of the border square, seen upright; panel frame, m.
  std::array<Vector3d, 4> corners_panel() const;
};

enum class HandleKind { lever, valve, wheel };
std::string_view nameOf(HandleKind kind);

/// A handle turns about the panel's z axis through its position; at angle 0 it points along the panel's x
/// axis.
struct Handle {
  std::string id;
  HandleKind kind = HandleKind::lever;
  Vector3d position_panel = Vector3d::Zero();  ///< m
  double radius_m = 0, length_m = 0;
  double smallest_angle_rad = 0, largest_angle_rad = 0;
  double angle_rad = 0;  ///< its state; the rest is as built
};

struct PanelMap {
  std::string name;
  Pose T_odom_panel;
  double position_sigma_m = 0, angle_sigma_rad = 0;  ///< of T_odom_panel; 0: known
  std::string mesh_file;                             ///< as written in the map, relative to it
  double white_albedo = 0.85, black_albedo = 0.04;   ///< linear
  Surface body;                                      ///< the mesh: without markers and handles
  std::vector<Marker> markers;
  std::vector<Handle> handles;

  /// Sets a handle's state. Throws std::invalid_argument: no such handle, or the angle is outside its range.
  void turnHandle(std::string_view id, double angle_rad);
};

/// Strict, see core/yaml.h; reads and checks the mesh too. Throws Error.
PanelMap readPanelMap(const std::filesystem::path& file);
/// The map with the handles' present state, as YAML that reads back to the same.
std::string formatPanelMap(const PanelMap& map);

/// All there is to see, panel frame: body, markers cell by cell, handles in their present state.
Surface surfaceOf(const PanelMap& map);

}  // namespace fathom
