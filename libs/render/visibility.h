#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "panel/surface.h"

namespace fathom {

/// The pinhole raster that OSMesa draws: sample (column, row) looks along the ideal image coordinates
/// (x0 + column * step_x, y0 + row * step_y), camera frame, y down.
struct Raster {
  int columns = 0, rows = 0;
  double x0 = 0, y0 = 0;
  double step_x = 0, step_y = 0;

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// Which triangle each sample of a raster sees. The only file that knows OSMesa, which has left newer
/// releases of Mesa: another rasterizer would replace this one file.
///
/// One GL context each; use it from one thread at a time. Mesa reads the environment variable LP_NUM_THREADS
/// when a process makes its first context: the number of its own threads, by default as many as cores. It
/// lets one context of a process rasterize at a time, with all of these, so the default serves one thread as
/// well as many.
class VisibilityBuffer {
 public:
  /// Draws so many of the raster's rows at a time. Throws std::runtime_error where OSMesa gives no GL 3.3
  /// core context with clip control, or no raster of this size.
  VisibilityBuffer(const Raster& raster, int rows);
  ~VisibilityBuffer();
  VisibilityBuffer(VisibilityBuffer&&) noexcept;
  VisibilityBuffer& operator=(VisibilityBuffer&&) noexcept;

  void setScene(const Surface& surface_odom);
  /// Row by row, beginning with this one (the top is 0): 0 for nothing, otherwise 1 + the triangle's number.
  /// Triangles nearer than 1 cm are cut off; both sides of a triangle are seen.
  const std::vector<std::uint32_t>& draw(const Pose& T_camera_odom, int first_row);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace fathom
