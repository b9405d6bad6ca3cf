#include "panel/face.h"
#include "panel/marker_family.h"
#include "panel/panel_map.h"

namespace fathom {
namespace {

/// A marker printed on nothing is lifted so much, lest it fight with the face for the pixels.
constexpr double kInk_m = 0.0002;

void addCell(const Vector3d& top_left, double side_m, const Eigen::Vector3f& albedo, Surface& surface) {
  const auto first = static_cast<std::uint32_t>(surface.vertices.size());
  for (const auto& [right, down] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, 0)}) {
    const Vector3d corner = top_left + side_m * Vector3d(right, -down, 0);
    surface.vertices.push_back({corner.cast<float>(), Eigen::Vector3f::UnitZ(), albedo});
  }
  surface.triangles.push_back({first, first + 1, first + 2});
  surface.triangles.push_back({first, first + 2, first + 3});
}

/// Marker frame. Every cell is a square of its own: joined to bars they would be fewer triangles, but
/// slivers, whose corners a renderer loses, and with corners on each other's edges, which leak.
Surface cellsOf(const MarkerPattern& pattern, double border_m, const Eigen::Vector3f& white_albedo,
                const Eigen::Vector3f& black_albedo) {
  const double cell_m = border_m / pattern.border_cells, half_m = cell_m * pattern.cells / 2;
  Surface surface;
  for (int row = 0; row < pattern.cells; ++row)
    for (int column = 0; column < pattern.cells; ++column)
      addCell({column * cell_m - half_m, half_m - row * cell_m, 0}, cell_m,
              pattern.whiteAt(row, column) ? white_albedo : black_albedo, surface);
  return surface;
}

/// Of a print, with what covers it.
Eigen::Vector3f seenAlbedo(double print, const Marker& marker) {
  const Vector3d clean = Vector3d::Constant(print);
  return (clean + marker.covered * (marker.cover_albedo - clean)).cast<float>();
}

}  // namespace

Surface surfaceOf(const PanelMap& map) {
  Surface surface = map.body;
  for (const Marker& marker : map.markers) {
    Pose T_panel_cells = marker.T_panel_marker;
    if (const auto face_z = faceHeight_m(map.body, T_panel_cells.position))
      T_panel_cells.position.z() = std::max(T_panel_cells.position.z(), *face_z + kInk_m);
    surface.add(cellsOf(markerPattern(marker.family, marker.id, marker.look), marker.size_m,
                        seenAlbedo(map.white_albedo, marker), seenAlbedo(map.black_albedo, marker)),
                T_panel_cells);
  }
  for (const Handle& handle : map.handles) surface.add(surfaceOf(handle), handle.T_panel_handle());
  return isAsMapped(map.shape) ? surface : shaped(surface, map.shape, map.half_extent_m);
}

}  // namespace fathom
