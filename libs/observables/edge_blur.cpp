#include "observables/edge_blur.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/linear_algebra.h"

namespace fathom {
namespace {

constexpr double kReachSigmas = 4;

/// A normal blur of this covariance that moves the image too.
struct Blur {
  Eigen::Matrix2d covariance_px2;
  Vector2d shift_px = Vector2d::Zero();
};

cv::Mat kernelOf(const Blur& blur) {
  const auto& [covariance, shift] = blur;
  const int reach = static_cast<int>(
      std::ceil(kReachSigmas * std::sqrt(covariance.diagonal().maxCoeff()) + shift.cwiseAbs().maxCoeff()));
  const Eigen::Matrix2d precision = covariance.inverse();
  cv::Mat weights(2 * reach + 1, 2 * reach + 1, CV_32FC1);
  for (int v = -reach; v <= reach; ++v)
    for (int u = -reach; u <= reach; ++u) {
      const Vector2d at = Vector2d(u, v) + shift;
      weights.at<float>(v + reach, u + reach) = static_cast<float>(std::exp(-0.5 * at.dot(precision * at)));
    }
  return weights / cv::sum(weights)[0];
}

cv::Mat filtered(const cv::Mat& image, const cv::Mat& weights) {
  cv::Mat result;
  cv::filter2D(image, result, CV_32F, weights, {-1, -1}, 0, cv::BORDER_REPLICATE);
  return result;
}

/// Its derivatives, of fourth order: only how fast the solution is reached depends on them.
cv::Mat derivative(const cv::Mat& image, int by_x, int by_y) {
  static const std::array<std::vector<float>, 3> kernels{
      {{1.0F},
       {1 / 12.0F, -8 / 12.0F, 0, 8 / 12.0F, -1 / 12.0F},
       {-1 / 12.0F, 16 / 12.0F, -30 / 12.0F, 16 / 12.0F, -1 / 12.0F}}};
  cv::Mat result;
  cv::sepFilter2D(image, result, CV_32F, kernels[static_cast<std::size_t>(by_x)],
                  kernels[static_cast<std::size_t>(by_y)], {-1, -1}, 0, cv::BORDER_REPLICATE);
  return result;
}

/// What the seen image is a sum of: light, veil and the share of what is around, the first two each constant,
/// in x and in y; then the rendering's derivatives, by which it is shifted and blurred.
constexpr int kColumns = 12;
constexpr int kGain = 4, kShift = 7, kBlur = 9;

std::array<cv::Mat, kColumns> columnsOf(const EdgeView& view, const Blur& blur) {
  const cv::Size size = view.rendered.size();
  cv::Mat x(size, CV_32FC1), y(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) {
      x.at<float>(v, u) = static_cast<float>(u) / static_cast<float>(size.width) - 0.5F;
      y.at<float>(v, u) = static_cast<float>(v) / static_cast<float>(size.height) - 0.5F;
    }
  const cv::Mat soft = filtered(view.rendered, kernelOf(blur));
  return {cv::Mat::ones(size, CV_32FC1),
          x,
          y,
          view.around,
          soft,
          x.mul(soft),
          y.mul(soft),
          derivative(soft, 1, 0),
          derivative(soft, 0, 1),
          0.5 * derivative(soft, 2, 0),
          derivative(soft, 1, 1),
          0.5 * derivative(soft, 0, 2)};
}

Eigen::VectorXd valuesAt(const cv::Mat& image, const std::vector<cv::Point>& where) {
  Eigen::VectorXd values(std::ssize(where));
  for (std::size_t i = 0; i < where.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = image.at<float>(where[i]);
  return values;
}

Eigen::MatrixXd stacked(const std::array<cv::Mat, kColumns>& columns, const std::vector<cv::Point>& where) {
  Eigen::MatrixXd A(std::ssize(where), kColumns);
  for (int c = 0; c < kColumns; ++c) A.col(c) = valuesAt(columns[static_cast<std::size_t>(c)], where);
  return A;
}

/// A^T times the covariance of smoothed white noise times A: of the columns smoothed themselves.
Eigen::MatrixXd noiseGram(const Eigen::MatrixXd& A, const std::vector<cv::Point>& where, const cv::Size& size,
                          double smoothing_px) {
  std::array<cv::Mat, kColumns> smoothed;
  for (int c = 0; c < kColumns; ++c) {
    cv::Mat column = cv::Mat::zeros(size, CV_32FC1);
    for (std::size_t i = 0; i < where.size(); ++i)
      column.at<float>(where[i]) = static_cast<float>(A(static_cast<Eigen::Index>(i), c));
    cv::GaussianBlur(column, smoothed[static_cast<std::size_t>(c)], {}, smoothing_px, smoothing_px,
                     cv::BORDER_CONSTANT);
  }
  std::vector<cv::Point> all;
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) all.emplace_back(u, v);
  const Eigen::MatrixXd B = stacked(smoothed, all);
  return B.transpose() * B;
}

std::vector<cv::Point> pixelsOf(const cv::Mat& mask, int border_px) {
  std::vector<cv::Point> where;
  for (int v = border_px; v < mask.rows - border_px; ++v)
    for (int u = border_px; u < mask.cols - border_px; ++u)
      if (mask.at<std::uint8_t>(v, u) != 0) where.emplace_back(u, v);
  return where;
}

/// Standard deviation.
double contrast(const cv::Mat& image, const std::vector<cv::Point>& where) {
  const Eigen::VectorXd values = valuesAt(image, where);
  return std::sqrt((values.array() - values.mean()).square().mean());
}

}  // namespace

int edgeReach_px(const EdgeBlurOptions& options) {
  return static_cast<int>(std::ceil(kReachSigmas * options.smoothing_px));
}

std::optional<EdgeBlur> edgeBlur(const EdgeView& view, const EdgeBlurOptions& options) {
  const std::vector<cv::Point> where = pixelsOf(view.mask, edgeReach_px(options));
  if (std::ssize(where) < options.least_pixels || contrast(view.rendered, where) < options.least_contrast)
    return std::nullopt;
  const Eigen::Matrix2d own = options.smoothing_px * options.smoothing_px * Eigen::Matrix2d::Identity();
  const Eigen::VectorXd y = valuesAt(filtered(view.seen, kernelOf({own})), where);
  EdgeBlur found;
  for (int round = 0; round < options.rounds; ++round) {
    const Vector3d& more = found.variance_px2;
    const Blur blur{own + Eigen::Matrix2d{{more[0], more[1]}, {more[1], more[2]}}, found.shift_px};
    const bool is_possible = blur.covariance_px2.diagonal().minCoeff() > 0 &&
                             blur.covariance_px2.determinant() > 0.1 * own.determinant();
    if (!is_possible || found.shift_px.norm() > options.largest_shift_px) return std::nullopt;
    const Eigen::MatrixXd A = stacked(columnsOf(view, blur), where);
    const SymmetricFactors normal(A.transpose() * A);
    const Eigen::VectorXd x = normal.solve(A.transpose() * y);
    if (!normal.succeeded() || !x.allFinite() || std::abs(x[kGain]) < 1e-6) return std::nullopt;
    found.variance_px2 += x.segment<3>(kBlur) / x[kGain];
    found.shift_px -= x.segment<2>(kShift) / x[kGain];
    if (round + 1 < options.rounds) continue;
    // Smoothed white noise has 1 / (4 pi s^2) of its variance.
    const double kept = 1 / (4 * std::numbers::pi * own(0, 0));
    const double left = (y - A * x).squaredNorm() / static_cast<double>(std::ssize(where));
    const double variance = std::max(view.noise * view.noise, left / kept);
    const Eigen::MatrixXd inverse = normal.solve(Eigen::MatrixXd::Identity(kColumns, kColumns));
    const Eigen::MatrixXd spread =
        inverse * noiseGram(A, where, view.seen.size(), options.smoothing_px) * inverse;
    found.covariance_px4 = variance / (x[kGain] * x[kGain]) * spread.block<3, 3>(kBlur, kBlur);
  }
  return found;
}

}  // namespace fathom
