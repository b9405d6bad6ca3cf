#include "render/lens.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/parallel.h"

namespace fathom {
namespace {

constexpr double kSparsest_px = 1.15;  // distance of raster samples: what is wider is not missed
constexpr double kHuge = 1e9;

void checkCamera(const CameraModel& camera) {
  if (camera.width_px <= 0 || camera.height_px <= 0)
    throw std::invalid_argument("a camera needs a positive width and height");
  if (!(camera.fx_px > 0) || !(camera.fy_px > 0) || !std::isfinite(camera.fx_px * camera.fy_px))
    throw std::invalid_argument("a camera needs positive focal lengths");
}

/// How ideal image coordinates change along the image's axes (its columns): the inverse's derivative is the
/// inverse of the derivative, which central differences give to 1e-9.
Eigen::Matrix2d idealPerPixel(const CameraModel& camera, const Vector2d& ideal) {
  constexpr double h = 1e-5;
  Eigen::Matrix2d pixel_per_ideal;
  for (int k = 0; k < 2; ++k) {
    const Vector2d step = h * Vector2d::Unit(k);
    const Vector2d ahead = ideal + step, behind = ideal - step;
    pixel_per_ideal.col(k) =
        (camera.project<double>(ahead.homogeneous()) - camera.project<double>(behind.homogeneous())) /
        (2 * h);
  }
  if (!(pixel_per_ideal.determinant() > 0)) return Eigen::Matrix2d::Constant(std::nan(""));
  return pixel_per_ideal.inverse();
}

/// What the pixels of a row, or of all rows, see.
struct Extent {
  Vector2d smallest = Vector2d::Constant(kHuge), largest = Vector2d::Constant(-kHuge);
  Vector2d widest = Vector2d::Zero(), narrowest = Vector2d::Constant(kHuge);  ///< of a pixel

  void add(const Extent& other) {
    smallest = smallest.cwiseMin(other.smallest);
    largest = largest.cwiseMax(other.largest);
    widest = widest.cwiseMax(other.widest);
    narrowest = narrowest.cwiseMin(other.narrowest);
  }
};

struct Row {
  Extent extent;
  std::string why_not;  ///< there is no sight at one of its pixels
};

/// Writes where its pixels look.
Row rowOf(const CameraModel& camera, int v, float* x, float* y) {
  Row row;
  const auto at = [&](int u) { return " at pixel (" + std::to_string(u) + ", " + std::to_string(v) + ")"; };
  for (int u = 0; u < camera.width_px; ++u) {
    const Vector2d pixel(u, v), ideal = camera.idealAt(pixel);
    // Past the distortion's turning point there is no inverse, or one on the wrong branch.
    if (!((camera.project<double>(ideal.homogeneous()) - pixel).norm() < 1e-6))
      return {{}, "the camera's distortion has no inverse" + at(u)};
    const Eigen::Matrix2d along = idealPerPixel(camera, ideal);
    if (!along.allFinite()) return {{}, "the camera's distortion folds the image over" + at(u)};
    x[u] = static_cast<float>(ideal.x());
    y[u] = static_cast<float>(ideal.y());
    const Vector2d size = along.cwiseAbs().rowwise().sum();
    row.extent.add({ideal, ideal, size, size});
  }
  return row;
}

}  // namespace

PixelSquare Lens::square(std::size_t pixel) const {
  const Eigen::Vector2f centre(x[pixel], y[pixel]);
  const Eigen::Matrix2f along = idealPerPixel(camera, centre.cast<double>()).cast<float>();
  return {centre, along.col(0), along.col(1)};
}

Lens::Lens(const CameraModel& its_camera) : camera(its_camera) {
  checkCamera(camera);
  const auto columns = static_cast<std::size_t>(camera.width_px),
             rows = static_cast<std::size_t>(camera.height_px);
  x.resize(columns * rows);
  y.resize(x.size());
  std::vector<Row> each(rows);
  parallelFor(rows, [&](std::size_t v) {
    each[v] = rowOf(camera, static_cast<int>(v), &x[columns * v], &y[columns * v]);
  });
  Extent all;
  for (const Row& row : each) {
    if (!row.why_not.empty()) throw std::invalid_argument(row.why_not);
    all.add(row.extent);
  }
  // So many samples along the widest pixel that the narrowest has one too. A pixel as wide as `samples` steps
  // lies, wherever it is, within samples + 2 samples in a row.
  const int samples =
      static_cast<int>(std::ceil(all.widest.cwiseQuotient(all.narrowest).maxCoeff() / kSparsest_px));
  const Vector2d step = all.widest / samples;
  block_side = samples + 2;
  const Vector2d first = all.smallest - block_side * step;
  const auto count = [&](int k) {
    return static_cast<int>(std::ceil((all.largest[k] - first[k]) / step[k])) + block_side + 1;
  };
  raster = {count(0), count(1), first.x(), first.y(), step.x(), step.y()};
  block.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double column = (static_cast<double>(x[i]) - raster.x0) / raster.step_x - 0.5 * samples;
    const double row = (static_cast<double>(y[i]) - raster.y0) / raster.step_y - 0.5 * samples;
    block.push_back(static_cast<std::uint32_t>(std::floor(row)) * static_cast<std::uint32_t>(raster.columns) +
                    static_cast<std::uint32_t>(std::floor(column)));
  }
}

}  // namespace fathom
