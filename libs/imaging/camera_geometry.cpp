#include "imaging/camera_geometry.h"

namespace fathom {

template <>
CameraProjector<double>::RowSought CameraProjector<double>::rowOf(const Vector3d& point_camera) const {
  using Slope = ceres::Jet<double, 1>;
  const Vector3<Slope> point = point_camera.cast<Slope>();
  double row = 0;
  for (int i = 0; i < 20; ++i) {
    const Slope seen = rowSeen(point, Slope(row, 0));
    const double step = (seen.a - row) / (1.0 - seen.v[0]);
    row = std::clamp(row + step, -height_px, 2.0 * height_px);
    if (std::abs(step) < 1e-11 * (1.0 + std::abs(row))) return {row, seen.v[0]};
  }
  return {row, std::nullopt};
}

namespace {
constexpr double kSteepest = 50;  // tan(theta_air)
}

double detail::solveSlope(const PortCrossing<double>& port) {
  double slope = 0;
  for (int i = 0; i < 100; ++i) {
    const double step = -port.miss(slope) / port.missBySlope(slope);
    slope += step;
    if (slope * slope * port.lateral_squared > kSteepest * kSteepest)
      return kSteepest / std::sqrt(port.lateral_squared);
    if (step <= 1e-15 * slope) break;
  }
  return slope;
}

double detail::solveApparent(const PortCrossing<double>& port, double apparent) {
  const double n2 = port.layers[0].index * port.layers[0].index;
  const double steepest = kSteepest / std::sqrt(port.lateral_squared);
  const double square = n2 / (1 + (1 - n2) * apparent * apparent * port.lateral_squared);
  if (!(square > 0 && square < steepest * steepest)) return steepest;
  double slope = apparent * std::sqrt(square);
  for (int i = 0; port.calibration_per_m != 0 && i < 20; ++i) {
    const double step = (apparent - port.apparent(slope)) / port.apparentBySlope(slope);
    slope += step;
    if (!(slope < steepest)) return steepest;
    if (std::abs(step) <= 1e-15 * slope) break;
  }
  return slope;
}

template Vector2<double> CameraProjector<double>::ideal(const Vector3<double>&) const;
template SightLine<double> CameraProjector<double>::lineOfSight(const Vector2d&) const;
template Vector3<double> apparentDirection(const FlatPort<double>&, const Vector3<double>&);
template SightLine<double> lightBehind(const FlatPort<double>&, const Vector3<double>&);
template std::array<Vector2<double>, 4> predictCorners(const KinematicState<double>&, PanelPlacement<double>,
                                                       const Marker&, const CameraModel&, const Pose&,
                                                       const EffectParameters<double>&, double, const Pose&);

}  // namespace fathom
