#include "imaging/forward_scatter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr int kPlaces = 6;  // on the way, of a single bend

/// At half the size, where it is as smooth: halving and doubling make a square pixel of the blur's variance.
cv::Mat blurred(const cv::Mat& half, const cv::Size& size, double variance_px2) {
  constexpr double kResizing_px2 = 1, kLeast_px2 = 0.25;
  const double sigma_px = std::sqrt(std::max(kLeast_px2, variance_px2 - kResizing_px2)) / 2;
  cv::Mat soft, result;
  cv::GaussianBlur(half, soft, {}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
  cv::resize(soft, result, size, 0, 0, cv::INTER_LINEAR);
  return result;
}

}  // namespace

cv::Mat bentLight(const cv::Mat& radiance, const CameraModel& camera, int bends) {
  const double bend_px2 = std::pow(camera.fx_px * kBend_rad, 2);
  cv::Mat half;
  cv::resize(radiance, half, {(radiance.cols + 1) / 2, (radiance.rows + 1) / 2}, 0, 0, cv::INTER_AREA);
  if (bends > 1) return blurred(half, radiance.size(), bends * bend_px2 / 3);
  cv::Mat mean = cv::Mat::zeros(radiance.size(), radiance.type());
  for (int place = 0; place < kPlaces; ++place)
    mean += blurred(half, radiance.size(), bend_px2 * std::pow((place + 0.5) / kPlaces, 2)) / kPlaces;
  return mean;
}

}  // namespace fathom
