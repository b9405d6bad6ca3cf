#pragma once

#include <cstdint>
#include <vector>

#include "core/camera_model.h"
#include "render/pixel.h"
#include "render/visibility.h"

namespace fathom {

/// A camera's lines of sight, pixel by pixel, row by row: what the distortion does, computed once.
struct Lens {
  CameraModel camera;
  /// Ideal image coordinates (x/z, y/z) of each pixel's centre.
  std::vector<float> x, y;
  PixelSquare square(std::size_t pixel) const;
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
