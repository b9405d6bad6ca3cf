#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/face_shape.h"
#include "core/geometry.h"
#include "panel/handle.h"
#include "panel/marker.h"
#include "panel/surface.h"

/// The knowledge base: what stands on the sea floor, and in which state its handles are. See
/// maps/dexrov/panel.yaml. Panel frame: centre of the front face; x right, y up, z out of the face.
namespace fathom {

struct PanelMap {
  std::string name;
  Pose T_odom_panel;
  double position_sigma_m = 0, angle_sigma_rad = 0;  ///< of T_odom_panel; 0: known
  std::string mesh_file;                             ///< as written in the map, relative to it
  double white_albedo = 0.85, black_albedo = 0.04;   ///< linear
  Surface body;                                      ///< the mesh: without markers and handles
  std::vector<std::string> materials;                ///< of the body, sorted
  int components = 0;                                ///< connected pieces of the body
  std::vector<Marker> markers;
  std::vector<Handle> handles;
  FaceShape<double> shape{};  ///< what surfaceOf() makes of all of it

  /// From the middle of the face to its furthest point, right and up: of markers, and of the body where that
  /// is at their height (legs are no part of the face; without markers, all of the body). See setExtent().
  Eigen::Vector2d half_extent_m = Eigen::Vector2d::Zero();

  /// Measures it, and tells it to the markers (Marker::panel_half_m).
  void setExtent();
  /// From the middle of the face to the furthest of its body, legs and all.
  Eigen::Vector2d reach_m() const;
  /// Sets a handle's state. Throws std::invalid_argument: no such handle, or the angle is outside its range.
  void turnHandle(std::string_view id, double angle_rad);

  /// How its markers are printed, all alike.
  MarkerLook look() const { return markers.empty() ? MarkerLook{} : markers.front().look; }
};

/// Strict, see core/yaml.h; reads and checks the mesh too (mesh.h). Where the mesh has an object named
/// `handle_ID` for a handle of the map, that is left out of the body: it shows one state only, and
/// surfaceOf() draws the present one.
///
/// Throws Error, which names the key, also where a marker is unknown, there twice, looks like another one,
/// lies beside, behind or more than 1 cm in front of the face, or overlaps another one, and where a handle is
/// there twice, of unknown kind, or outside its range.
PanelMap readPanelMap(const std::filesystem::path& file);
/// The map with the handles' present state, as YAML that reads back to the same in the same folder (lengths
/// exactly, angles to 1e-12 rad).
std::string formatPanelMap(const PanelMap& map);

/// All there is to see, panel frame: body, markers cell by cell, handles in their present state. Markers are
/// flat sheets that look along z; all else is closed where the mesh is.
Surface surfaceOf(const PanelMap& map);

}  // namespace fathom
