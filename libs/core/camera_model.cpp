#include "core/camera_model.h"

#include <ceres/jet.h>

namespace fathom {

Vector2d CameraModel::idealAt(const Vector2d& pixel) const {
  using Jet = ceres::Jet<double, 2>;
  const Vector2d distorted((pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px);
  Vector2d ideal = distorted;
  for (int i = 0; i < 20; ++i) {
    const Vector2<Jet> d = distort(Vector2<Jet>(Jet(ideal.x(), 0), Jet(ideal.y(), 1)));
    Eigen::Matrix2d J;
    J << d.x().v.transpose(), d.y().v.transpose();
    const Vector2d step = J.inverse() * (distorted - Vector2d(d.x().a, d.y().a));
    ideal += step;
    if (step.squaredNorm() < 1e-26) break;
  }
  return ideal;
}

}  // namespace fathom
