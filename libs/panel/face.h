#pragma once

#include <array>
#include <optional>

#include "panel/marker.h"
#include "panel/surface.h"

/// Markers and the face they lie on.
namespace fathom {

/// How near the face a marker lies.
inline constexpr double kMarkerDistance_m = 0.01;

/// Corners of the whole pattern, which can reach beyond the border square; in the order of corners_panel().
std::array<Vector3d, 4> patternCorners_panel(const Marker& marker);

/// The height (z) of the foremost part of the body at this x and y that looks forward and lies within
/// kMarkerDistance_m of the point; nothing where there is none.
std::optional<double> faceHeight_m(const Surface& body, const Vector3d& point_panel);

/// Whether two squares share more than an edge, seen along the panel's z axis (separating axis theorem).
bool overlap(const std::array<Vector3d, 4>& a, const std::array<Vector3d, 4>& b);

/// Whether the same cells are seen in both border squares, turned or not.
bool lookAlike(const Marker& a, const Marker& b);

}  // namespace fathom
