#pragma once

#include <cstdint>
#include <vector>

#include "core/camera_model.h"
#include "render/pixel.h"
#include "render/visibility.h"

namespace fathom {

/// A camera's lines of sight, pixel by pixel, row by row: what the distortion does, computed once.
struct Lens {
  int width = 0, height = 0;  ///< pixels
  /// Ideal image coordinates (x/z, y/z) of each pixel's centre, and how they change along the image's axes:
  /// by (x_u, y_u) to the next column, by (x_v, y_v) to the next row.
  std::vector<float> x, y, x_u, y_u, x_v, y_v;
  PixelSquare square(std::size_t pixel) const {
    return {{x[pixel], y[pixel]}, {x_u[pixel], y_u[pixel]}, {x_v[pixel], y_v[pixel]}};
  }
  /// Covers the image, with about as many samples as pixels, and everywhere at least as many.
  Raster raster;
  /// The samples on and just around each pixel: a square block of so many columns and rows, beginning at this
  /// sample (row * columns + column in the raster).
  int block_side = 0;
  std::vector<std::uint32_t> block;

  /// Throws std::invalid_argument: not a size or focal length, or a distortion without an inverse in the
  /// image.
  explicit Lens(const CameraModel& camera);
};

}  // namespace fathom
