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

/// Corners of a marker's border square in its own axes, right and up, in units of half its size: top-left,
/// top-right, bottom-right, bottom-left. Every list of corners has this order.
inline constexpr std::array<std::array<int, 2>, 4> kMarkerCorners{{{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}};

/// A planar square fiducial on the face. Marker frame: centre of the marker; x right, y up, z out of the
/// face, seen upright (see marker_family.h).
struct Marker {
  std::string family;  ///< see marker_family.h
  int id = 0;
  double size_m = 0;    ///< side of the border square
  Pose T_panel_marker;  ///< turned about the panel's z axis, counter-clockwise seen from in front

  /// In the order of kMarkerCorners; panel frame, m.
  std::array<Vector3d, 4> corners_panel() const;
};

/// "family id", as in messages.
std::string nameOf(const Marker& marker);

enum class HandleKind { lever, valve, wheel };
std::string_view nameOf(HandleKind kind);

/// A handle turns about the panel's z axis through its position, counter-clockwise seen from in front; at
/// angle 0 it points along the panel's x axis (a wheel: its marked spoke).
struct Handle {
  std::string id;
  HandleKind kind = HandleKind::lever;
  Vector3d position_panel = Vector3d::Zero();  ///< where its axis meets what carries it, m
  double radius_m = 0;                         ///< of its base; of a wheel, its own
  double length_m = 0;                         ///< of its arm or bar, end to end; a wheel's does not matter
  double smallest_angle_rad = 0, largest_angle_rad = 0;
  double angle_rad = 0;  ///< its state; the rest is as built

  Pose T_panel_handle() const;  ///< handle frame: x where it points, z out of the face
};

/// Its shape, handle frame: closed pieces, rounded ones with smooth normals.
Surface surfaceOf(const Handle& handle);
/// How far before its foot the straight edges lie by which its angle is seen: those of its arm, its bar, its
/// marked spoke.
double edgeHeight_m(const Handle& handle);

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

  /// Sets a handle's state. Throws std::invalid_argument: no such handle, or the angle is outside its range.
  void turnHandle(std::string_view id, double angle_rad);
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
