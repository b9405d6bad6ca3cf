#include "sensors/forward_scatter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {

/// At half the size, where it is as smooth: halving and doubling make a square pixel of the blur's variance.
cv::Mat blurred(const cv::Mat& radiance, const CameraModel& camera, double blur) {
  constexpr double kResizing_px2 = 1, kLeast_px2 = 0.25;
  const double variance_px2 = blur / 3 * std::pow(camera.fx_px * kBend_rad, 2);
  const double sigma_px = std::sqrt(std::max(kLeast_px2, variance_px2 - kResizing_px2)) / 2;
  cv::Mat half, soft, result;
  cv::resize(radiance, half, {(radiance.cols + 1) / 2, (radiance.rows + 1) / 2}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(half, soft, {}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
  cv::resize(soft, result, radiance.size(), 0, 0, cv::INTER_LINEAR);
  return result;
}

}  // namespace fathom
