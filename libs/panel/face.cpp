#include "panel/face.h"

#include <algorithm>

#include "panel/marker_family.h"

namespace fathom {
namespace {

using Eigen::Vector2d;

constexpr double kForward = 0.9;     // least z of a normal that looks forward
constexpr double kOnEdge_m = 1e-6;   // a corner on the very edge is on the face
constexpr double kOverlap_m = 1e-6;  // two squares that touch do not overlap

/// The triangle's z at (x, y), where it is over it; barycentric coordinates, with `margin_m` around the
/// edges.
std::optional<double> heightAt(const std::array<Vector3d, 3>& t, const Vector3d& point, double margin_m) {
  const auto cross = [](const Vector2d& u, const Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); };
  const double twice_area = cross((t[1] - t[0]).head<2>(), (t[2] - t[0]).head<2>());
  double height = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d &from = t[(i + 1) % 3], &to = t[(i + 2) % 3];
    const Vector2d edge = (to - from).head<2>();
    const double inside = cross(edge, (point - from).head<2>());  // edge length times distance to the edge
    if (inside < -margin_m * edge.norm()) return std::nullopt;
    height += inside / twice_area * t[i].z();
  }
  return height;
}

/// Whether some edge of a separates the squares.
bool separated(const std::array<Vector3d, 4>& a, const std::array<Vector3d, 4>& b) {
  for (std::size_t i = 0; i < 4; ++i) {
    // Corners run clockwise: the left of an edge is outside.
    const Vector2d edge = (a[(i + 1) % 4] - a[i]).head<2>().normalized();
    const Vector2d outwards(-edge.y(), edge.x());
    const bool all_outside = std::all_of(b.begin(), b.end(), [&](const Vector3d& corner) {
      return outwards.dot((corner - a[i]).head<2>()) > -kOverlap_m;
    });
    if (all_outside) return true;
  }
  return false;
}

/// The border square's cells, turned by quarter turns.
std::vector<bool> borderSquare(const MarkerPattern& pattern, int quarter_turns) {
  const int first = (pattern.cells - pattern.border_cells) / 2, last = pattern.border_cells - 1;
  std::vector<bool> white;
  for (int row = 0; row <= last; ++row)
    for (int column = 0; column <= last; ++column) {
      int r = row, c = column;
      for (int turn = 0; turn < quarter_turns; ++turn) {
        const int turned = last - c;
        c = r;
        r = turned;
      }
      white.push_back(pattern.whiteAt(first + r, first + c));
    }
  return white;
}

}  // namespace

std::array<Vector3d, 4> patternCorners_panel(const Marker& marker) {
  const MarkerPattern pattern = markerPattern(marker.family, marker.id, marker.look);
  Marker whole = marker;
  whole.size_m *= static_cast<double>(pattern.cells) / pattern.border_cells;
  return whole.corners_panel();
}

std::optional<double> faceHeight_m(const Surface& body, const Vector3d& point_panel) {
  std::optional<double> foremost;
  for (const auto& [a, b, c] : body.triangles) {
    if (body.vertices[a].normal.z() < kForward) continue;
    const auto height =
        heightAt({body.vertices[a].position.cast<double>(), body.vertices[b].position.cast<double>(),
                  body.vertices[c].position.cast<double>()},
                 point_panel, kOnEdge_m);
    if (height && std::abs(*height - point_panel.z()) <= kMarkerDistance_m &&
        (!foremost || *height > *foremost))
      foremost = height;
  }
  return foremost;
}

bool overlap(const std::array<Vector3d, 4>& a, const std::array<Vector3d, 4>& b) {
  return !separated(a, b) && !separated(b, a);
}

bool lookAlike(const Marker& a, const Marker& b) {
  const MarkerPattern pattern_a = markerPattern(a.family, a.id), pattern_b = markerPattern(b.family, b.id);
  for (int turns = 0; turns < 4; ++turns)
    if (borderSquare(pattern_a, 0) == borderSquare(pattern_b, turns)) return true;
  return false;
}

}  // namespace fathom
