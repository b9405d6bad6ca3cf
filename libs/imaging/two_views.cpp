#include "imaging/two_views.h"

#include <Eigen/QR>

namespace fathom {
namespace detail {

Intersection intersectionOf(const SeenByBoth& seen, const std::array<CameraProjector<double>, 2>& projectors,
                            const Matrix3d& R_left_right, const Vector3d& right_in_left) {
  const SightLine<double> left = projectors[0].lineOfSight(seen.pixels[0]),
                          right = projectors[1].lineOfSight(seen.pixels[1]);
  const Vector3d &a = left.direction, b = R_left_right * right.direction;
  const Vector3d between = right_in_left + R_left_right * right.origin - left.origin;
  const double ab = a.dot(b), singular = 1 - ab * ab;
  const double along_a = (between.dot(a) - ab * between.dot(b)) / singular,
               along_b = (ab * between.dot(a) - between.dot(b)) / singular;
  Intersection result;
  result.point = 0.5 * (2 * left.origin + along_a * a + between + along_b * b);

  using Jet = ceres::Jet<double, 3>;
  Eigen::Vector4d reading;
  reading << seen.pixels[0] / seen.sigma_px[0], seen.pixels[1] / seen.sigma_px[1];
  constexpr int kSteps = 4;
  for (int step = 0; step <= kSteps; ++step) {
    const Vector3<Jet> point(Jet(result.point.x(), 0), Jet(result.point.y(), 1), Jet(result.point.z(), 2));
    const auto predicted = seenOf<Jet>(seen, projectors, R_left_right, right_in_left, point);
    Eigen::Matrix<double, 4, 3> J;
    Eigen::Vector4d error;
    for (Eigen::Index i = 0; i < 4; ++i) {
      J.row(i) = predicted[i].v.transpose();
      error[i] = reading[i] - predicted[i].a;
    }
    const Eigen::HouseholderQR<Eigen::Matrix<double, 4, 3>> qr(J);
    if (step < kSteps) {
      result.point += qr.solve(error);
    } else {
      result.normal = qr.householderQ() * Eigen::Vector4d::Unit(3);
    }
  }
  return result;
}

}  // namespace detail

Eigen::Vector4d contradictionSense(const SeenByBoth& seen, const Pose& T_left_right) {
  return detail::intersectionOf(seen,
                                {CameraProjector<double>::nominal(seen.cameras[0]),
                                 CameraProjector<double>::nominal(seen.cameras[1])},
                                T_left_right.rotation, T_left_right.position)
      .normal;
}

}  // namespace fathom
