#pragma once

#include <cstdint>
#include <vector>

#include "core/camera_model.h"
#include "render/visibility.h"

namespace fathom {

/// A camera's lines of sight, pixel by pixel, row by row: what the distortion does, computed once.
struct Lens {
  /// Ideal image coordinates (x/z, y/z) of each pixel's centre, and how they change along the image's axes:
  /// by (x_u, y_u) to the next column, by (x_v, y_v) to the next row.
  std::vector<float> x, y, x_u, y_u, x_v, y_v;
  /// Covers the image. Its samples are nowhere closer than the pixels, so that the nearest sample to a pixel's
  /// centre and the eight around it surround the pixel.
  Raster raster;
  std::vector<std::uint32_t> nearest;  ///< of each pixel's centre: row * columns + column in the raster

  /// Throws std::invalid_argument: not a size or focal length, or a distortion without an inverse in the
  /// image.
  explicit Lens(const CameraModel& camera);
};

}  // namespace fathom
