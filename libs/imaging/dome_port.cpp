#include "imaging/dome_port.h"

namespace fathom::detail {

Apparent solveApparent(const DomePort<double>& dome, const Vector3d& point_camera) {
  using Slope = ceres::Jet<double, 2>;
  constexpr int kMostSteps = 20;
  constexpr double kConverged = 1e-14;
  Apparent found{point_camera.head<2>() / point_camera.z()};
  for (int i = 0; i < kMostSteps; ++i) {
    const Vector2<Slope> at(Slope(found.direction.x(), 0), Slope(found.direction.y(), 1));
    const Vector2<Slope> miss = missOf(dome, at, Vector3<Slope>(point_camera.cast<Slope>()));
    found.miss_by << miss.x().v.transpose(), miss.y().v.transpose();
    const Vector2d step = found.miss_by.inverse() * Vector2d(miss.x().a, miss.y().a);
    if (!(step.norm() > kConverged)) break;
    found.direction -= step;
  }
  return found;
}

}  // namespace fathom::detail
