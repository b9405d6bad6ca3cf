#pragma once

#include <array>

#include "imaging/camera_geometry.h"

/// A point that both cameras of a pair see, wherever it is: their lines of sight should meet.
namespace fathom {

/// What a pair of cameras sees of one point that may be anywhere.
struct SeenByBoth {
  std::array<CameraModel, 2> cameras;  ///< left, right
  std::array<Vector2d, 2> pixels;
  std::array<double, 2> sigma_px{1, 1};
};

namespace detail {

/// The pair's two projections of a point in the left camera's frame, in units of sigma: left x, y, right x,
/// y.
template <class T, class P>
Eigen::Matrix<T, 4, 1> seenOf(const SeenByBoth& seen, const std::array<CameraProjector<P>, 2>& projectors,
                              const Matrix3<P>& R_left_right, const Vector3<P>& right_in_left,
                              const Vector3<T>& point) {
  const Vector3<T> in_right =
      R_left_right.template cast<T>().transpose() * (point - right_in_left.template cast<T>());
  Eigen::Matrix<T, 4, 1> pixels;
  pixels << projectors[0].project(point) / seen.sigma_px[0],
      projectors[1].project(in_right) / seen.sigma_px[1];
  return pixels;
}

/// Where the point is: nearest to both lines of sight, then least squares in the images. `normal`: of the
/// surface of what can be seen of points (a direction of the four pixel coordinates), unit length.
struct Intersection {
  Vector3d point;
  Eigen::Vector4d normal;
};

Intersection intersectionOf(const SeenByBoth& seen, const std::array<CameraProjector<double>, 2>& projectors,
                            const Matrix3d& R_left_right, const Vector3d& right_in_left);

}  // namespace detail

/// By how much, in units of sigma, two cameras contradict each other about a point: what remains of the
/// reprojection error where the point is best, along the one direction of the four pixel coordinates in which
/// no point can move them (variable projection: Golub & Pereyra 1973; the direction's own change is left out,
/// Kaufman 1975). Its sign is that of `sense`, as contradictionSense() has it. `R_left_right`,
/// `right_in_left`: the right camera in the left one's frame.
template <class T>
T contradiction(const SeenByBoth& seen, const Matrix3<T>& R_left_right, const Vector3<T>& right_in_left,
                const EffectParameters<T>& effects, double t_s, const Eigen::Vector4d& sense) {
  const std::array projectors{cameraProjector(seen.cameras[0], effects, t_s),
                              cameraProjector(seen.cameras[1], effects, t_s)};
  const auto plain = [](const auto& matrix) {
    return matrix.unaryExpr([](const T& v) { return valueOf(v); });
  };
  const Matrix3d R = plain(R_left_right);
  const Vector3d p = plain(right_in_left);
  const auto best = detail::intersectionOf(seen, {projectors[0].values(), projectors[1].values()}, R, p);
  const auto predicted = detail::seenOf<T>(seen, projectors, R_left_right, right_in_left,
                                           Vector3<T>(best.point.template cast<T>()));
  T sum = T(0);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const std::size_t eye = i < 2 ? 0 : 1;
    sum += best.normal[i] * (predicted[i] - seen.pixels[eye][i % 2] / seen.sigma_px[eye]);
  }
  return best.normal.dot(sense) < 0 ? T(-sum) : sum;
}

/// A direction by which the sign of contradiction() can be kept, of cameras without effects.
Eigen::Vector4d contradictionSense(const SeenByBoth& seen, const Pose& T_left_right);

}  // namespace fathom
