#include "panel/face.h"
#include "panel/marker_family.h"
#include "panel/panel_map.h"

namespace fathom {
namespace {

/// A marker printed on nothing is lifted so much, lest it fight with the face for the pixels.
constexpr double kInk_m = 0.0002;

void addCells(const Vector3d& top_left, const Vector3d& right, const Vector3d& down,
              const Eigen::Vector3f& albedo, Surface& surface) {
  const auto first = static_cast<std::uint32_t>(surface.vertices.size());
  const Vector3d corners[] = {top_left, top_left + down, top_left + down + right, top_left + right};
  for (const auto& corner : corners)
    surface.vertices.push_back({corner.cast<float>(), Eigen::Vector3f::UnitZ(), albedo});
  surface.triangles.push_back({first, first + 1, first + 2});
  surface.triangles.push_back({first, first + 2, first + 3});
}

/// Marker frame. Equal cells of a row are one piece.
Surface cellsOf(const MarkerPattern& pattern, double border_m, float white_albedo, float black_albedo) {
  const double cell_m = border_m / pattern.border_cells, half_m = cell_m * pattern.cells / 2;
  Surface surface;
  for (int row = 0; row < pattern.cells; ++row)
    for (int begin = 0, end = 0; begin < pattern.cells; begin = end) {
      const bool white = pattern.whiteAt(row, begin);
      for (end = begin + 1; end < pattern.cells && pattern.whiteAt(row, end) == white;) ++end;
      addCells({begin * cell_m - half_m, half_m - row * cell_m, 0}, {(end - begin) * cell_m, 0, 0},
               {0, -cell_m, 0}, Eigen::Vector3f::Constant(white ? white_albedo : black_albedo), surface);
    }
  return surface;
}

}  // namespace

std::array<Vector3d, 4> Marker::corners_panel() const {
  const double half_m = size_m / 2;
  return {T_panel_marker * Vector3d(-half_m, half_m, 0), T_panel_marker * Vector3d(half_m, half_m, 0),
          T_panel_marker * Vector3d(half_m, -half_m, 0), T_panel_marker * Vector3d(-half_m, -half_m, 0)};
}

Surface surfaceOf(const PanelMap& map) {
  Surface surface = map.body;
  for (const Marker& marker : map.markers) {
    Pose T_panel_cells = marker.T_panel_marker;
    if (const auto face_z = faceHeight_m(map.body, T_panel_cells.position))
      T_panel_cells.position.z() = std::max(T_panel_cells.position.z(), *face_z + kInk_m);
    surface.add(cellsOf(markerPattern(marker.family, marker.id), marker.size_m,
                        static_cast<float>(map.white_albedo), static_cast<float>(map.black_albedo)),
                T_panel_cells);
  }
  for (const Handle& handle : map.handles) surface.add(surfaceOf(handle), handle.T_panel_handle());
  return surface;
}

}  // namespace fathom
