#include "render/lens.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fathom {
namespace {

constexpr double kSparsest_px = 1.15;  // distance of raster samples: what is wider is not missed

void checkCamera(const CameraModel& camera) {
  if (camera.width_px <= 0 || camera.height_px <= 0)
    throw std::invalid_argument("a camera needs a positive width and height");
  if (!(camera.fx_px > 0) || !(camera.fy_px > 0) || !std::isfinite(camera.fx_px * camera.fy_px))
    throw std::invalid_argument("a camera needs positive focal lengths");
}

/// idealAt(), checked: past the distortion's turning point there is no inverse, or one on the wrong branch.
Vector2d checkedIdealAt(const CameraModel& camera, const Vector2d& pixel) {
  Vector2d ideal = camera.idealAt(pixel);
  const Vector2d back = camera.project<double>(ideal.homogeneous());
  if (!((back - pixel).norm() < 1e-6))
    throw std::invalid_argument("the camera's distortion has no inverse at pixel (" +
                                std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) + ")");
  return ideal;
}

struct Sight {
  Vector2d ideal, along_u, along_v;
};

/// The inverse's derivative is the inverse of the derivative, which central differences give to 1e-9.
Sight sightAt(const CameraModel& camera, const Vector2d& pixel) {
  const Vector2d ideal = checkedIdealAt(camera, pixel);
  constexpr double h = 1e-5;
  Eigen::Matrix2d pixel_per_ideal;
  for (int k = 0; k < 2; ++k) {
    const Vector2d step = h * Vector2d::Unit(k);
    const Vector2d ahead = ideal + step, behind = ideal - step;
    pixel_per_ideal.col(k) =
        (camera.project<double>(ahead.homogeneous()) - camera.project<double>(behind.homogeneous())) /
        (2 * h);
  }
  if (!(pixel_per_ideal.determinant() > 0))
    throw std::invalid_argument("the camera's distortion folds the image over at pixel (" +
                                std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) + ")");
  const Eigen::Matrix2d ideal_per_pixel = pixel_per_ideal.inverse();
  return {ideal, ideal_per_pixel.col(0), ideal_per_pixel.col(1)};
}

}  // namespace

Lens::Lens(const CameraModel& camera) : width(camera.width_px), height(camera.height_px) {
  checkCamera(camera);
  constexpr double kHuge = 1e9;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (std::vector<float>* of_pixel : {&x, &y, &x_u, &y_u, &x_v, &y_v}) of_pixel->reserve(pixels);
  Vector2d smallest(kHuge, kHuge), largest(-kHuge, -kHuge), widest(0, 0), narrowest(kHuge, kHuge);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const Sight sight = sightAt(camera, Vector2d(u, v));
      x.push_back(static_cast<float>(sight.ideal.x()));
      y.push_back(static_cast<float>(sight.ideal.y()));
      x_u.push_back(static_cast<float>(sight.along_u.x()));
      y_u.push_back(static_cast<float>(sight.along_u.y()));
      x_v.push_back(static_cast<float>(sight.along_v.x()));
      y_v.push_back(static_cast<float>(sight.along_v.y()));
      smallest = smallest.cwiseMin(sight.ideal);
      largest = largest.cwiseMax(sight.ideal);
      const Vector2d pixel = sight.along_u.cwiseAbs() + sight.along_v.cwiseAbs();
      widest = widest.cwiseMax(pixel);
      narrowest = narrowest.cwiseMin(pixel);
    }
  // So many samples along the widest pixel that the narrowest has one too. A pixel as wide as `samples` steps
  // lies, wherever it is, within samples + 2 samples in a row.
  const int samples = static_cast<int>(std::ceil(widest.cwiseQuotient(narrowest).maxCoeff() / kSparsest_px));
  const Vector2d step = widest / samples;
  block_side = samples + 2;
  const Vector2d first = smallest - block_side * step;
  const auto count = [&](int k) {
    return static_cast<int>(std::ceil((largest[k] - first[k]) / step[k])) + block_side + 1;
  };
  raster = {count(0), count(1), first.x(), first.y(), step.x(), step.y()};
  block.reserve(pixels);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double column = (static_cast<double>(x[i]) - raster.x0) / raster.step_x - 0.5 * samples;
    const double row = (static_cast<double>(y[i]) - raster.y0) / raster.step_y - 0.5 * samples;
    block.push_back(static_cast<std::uint32_t>(std::floor(row)) * static_cast<std::uint32_t>(raster.columns) +
                    static_cast<std::uint32_t>(std::floor(column)));
  }
}

}  // namespace fathom
