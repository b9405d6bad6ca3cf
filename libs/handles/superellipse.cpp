#include "handles/superellipse.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr double kLeastAxis = 0.75, kLeastExponent = 1, kMostExponent = 10;
constexpr double kTiny = 1e-6;    // where a power has no derivative
constexpr int kManyPixels = 800;  // more tell no more of six numbers
constexpr int kSteps = 25, kStepsFromNear = 5;

/// Centre, half axes, turn, exponent.
using Numbers = std::array<double, 6>;

/// |x / a|^n + |y / b|^n, to the power of 1 / n.
template <class T>
T reachOf(const T* s, double x_px, double y_px) {
  using std::abs, std::cos, std::pow, std::sin;
  const T dx = x_px - s[0], dy = y_px - s[1], c = cos(s[4]), d = sin(s[4]);
  const T x = abs((c * dx + d * dy) / s[2]) + kTiny, y = abs((c * dy - d * dx) / s[3]) + kTiny;
  return pow(pow(x, s[5]) + pow(y, s[5]), 1.0 / s[5]);
}

/// 1 inside, 0 outside, over about a pixel.
template <class T>
T drawnAt(const T* s, double x_px, double y_px) {
  using std::exp;
  const T half_px = s[2] < s[3] ? s[2] : s[3];
  const T beyond_px = (reachOf(s, x_px, y_px) - 1.0) * half_px;
  if (beyond_px > T(12)) return T(0);
  if (beyond_px < T(-12)) return T(1);
  return 1.0 / (1.0 + exp(2.5 * beyond_px));
}

struct Pixel {
  double x_px, y_px, inside;

  template <class T>
  bool operator()(const T* s, T* residual) const {
    *residual = drawnAt(s, x_px, y_px) - inside;
    return true;
  }
};

Numbers numbersOf(const Superellipse& e) {
  return {e.centre_px.x(), e.centre_px.y(), e.half_axes_px.x(), e.half_axes_px.y(), e.turn_rad, e.exponent};
}

/// An ellipse has the same second moments.
Numbers fromMoments(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask, true);
  const double xx = m.mu20 / m.m00, yy = m.mu02 / m.m00, xy = m.mu11 / m.m00;
  const double mean = (xx + yy) / 2, apart = std::hypot((xx - yy) / 2, xy);
  return {m.m10 / m.m00,
          m.m01 / m.m00,
          std::max(kLeastAxis, 2 * std::sqrt(mean + apart)),
          std::max(kLeastAxis, 2 * std::sqrt(std::max(0.0, mean - apart))),
          0.5 * std::atan2(2 * xy, xx - yy),
          2.5};
}

}  // namespace

double Superellipse::reach(const Vector2d& pixel) const {
  const Numbers s = numbersOf(*this);
  return reachOf(s.data(), pixel.x(), pixel.y());
}

cv::Mat Superellipse::drawn(const cv::Size& size) const {
  const Numbers s = numbersOf(*this);
  cv::Mat image(size, CV_32FC1);
  image.forEach<float>(
      [&](float& value, const int* at) { value = static_cast<float>(drawnAt(s.data(), at[1], at[0])); });
  return image;
}

Superellipse superellipseOf(const cv::Mat& mask, const std::optional<Superellipse>& start) {
  Numbers s = start ? numbersOf(*start) : fromMoments(mask);
  ceres::Problem problem;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(mask.total()) / kManyPixels)));
  for (int row = 0; row < mask.rows; row += step)
    for (int column = 0; column < mask.cols; column += step)
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Pixel, 1, 6>(
              new Pixel{double(column), double(row), mask.at<uchar>(row, column) != 0 ? 1.0 : 0.0}),
          nullptr, s.data());
  for (const int axis : {2, 3}) problem.SetParameterLowerBound(s.data(), axis, kLeastAxis);
  problem.SetParameterLowerBound(s.data(), 5, kLeastExponent);
  problem.SetParameterUpperBound(s.data(), 5, kMostExponent);
  ceres::Solver::Options options;
  options.max_num_iterations = start ? kStepsFromNear : kSteps;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {{s[0], s[1]}, {s[2], s[3]}, s[4], s[5]};
}

}  // namespace fathom
