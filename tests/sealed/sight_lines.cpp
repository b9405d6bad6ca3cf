#include "sight_lines.h"

#include <algorithm>

namespace fathom::sealed {
namespace {

constexpr int kGridStep_px = 4;
constexpr int kBeyond_px = 4;  // half a pixel around the image is seen too

}  // namespace

SightLines::SightLines(const TrueCamera& camera, int width_px, int height_px)
    : width_px_(width_px),
      height_px_(height_px),
      columns_((width_px + 2 * kBeyond_px) / kGridStep_px + 1),
      rows_((height_px + 2 * kBeyond_px) / kGridStep_px + 1) {
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      Ray ray = camera.rayAt({column * kGridStep_px - kBeyond_px, row * kGridStep_px - kBeyond_px});
      ray.direction /= ray.direction.z();
      rays_.push_back(ray);
    }
}

Ray SightLines::at(const Vector2d& pixel) const {
  const double x = std::clamp((pixel.x() + kBeyond_px) / kGridStep_px, 0.0, columns_ - 1.001);
  const double y = std::clamp((pixel.y() + kBeyond_px) / kGridStep_px, 0.0, rows_ - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double right = x - column, below = y - row;
  const Ray* upper = &rays_[static_cast<std::size_t>(row * columns_ + column)];
  const Ray* lower = upper + columns_;
  const auto mixed = [&](Vector3d Ray::*part) -> Vector3d {
    return (1 - below) * ((1 - right) * upper[0].*part + right * upper[1].*part) +
           below * ((1 - right) * lower[0].*part + right * lower[1].*part);
  };
  return {mixed(&Ray::origin), mixed(&Ray::direction)};
}

}  // namespace fathom::sealed
