#pragma once

#include <array>
#include <string>

#include "core/geometry.h"
#include "panel/marker_family.h"

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
  MarkerLook look{};    ///< how it is printed
  /// By which its corners are off those of a square, in the order of kMarkerCorners; marker frame.
  Eigen::Matrix<double, 3, 4> off_square_m = Eigen::Matrix<double, 3, 4>::Zero();
  double covered = 0;  ///< share of its area with something on it
  Vector3d cover_albedo = Vector3d::Zero();
  Eigen::Vector2d panel_half_m = Eigen::Vector2d::Zero();  ///< PanelMap::half_extent_m of its panel

  /// In the order of kMarkerCorners; panel frame, m.
  std::array<Vector3d, 4> corners_panel() const;
};

/// Whether its border square is bright, on dark; else dark, on bright, as most are.
bool isBrightSquare(const std::string& family, const MarkerLook& look);

/// "family id", as in messages.
std::string nameOf(const Marker& marker);

}  // namespace fathom
