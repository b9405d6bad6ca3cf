#include "imaging/dome_port.h"

#include <algorithm>

namespace fathom::detail {

Apparent solveApparent(const DomePort<double>& dome, const Vector3d& point_camera) {
  using Slope = ceres::Jet<double, 2>;
  constexpr int kMostSteps = 50;
  constexpr double kConverged = 1e-14, kLongestStep = 0.3, kSteepest = 50;
  Apparent found{point_camera.head<2>() / point_camera.z()};
  for (int i = 0; i < kMostSteps; ++i) {
    const Vector2<Slope> at(Slope(found.direction.x(), 0), Slope(found.direction.y(), 1));
    const Vector2<Slope> miss = missOf(dome, at, Vector3<Slope>(point_camera.cast<Slope>()));
    found.miss_by << miss.x().v.transpose(), miss.y().v.transpose();
    const Vector2d step = found.miss_by.inverse() * Vector2d(miss.x().a, miss.y().a);
    if (!(step.norm() > kConverged)) break;
    found.direction -= step * std::min(1.0, kLongestStep * (1 + found.direction.norm()) / step.norm());
    if (!(found.direction.norm() < kSteepest)) {
      found.direction = kSteepest * point_camera.head<2>().normalized();
      break;
    }
  }
  return found;
}

}  // namespace fathom::detail
