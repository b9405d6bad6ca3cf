#include "imaging/forward_scatter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr int kPlaces = 6;  // on the way, of a single bend

/// An image at half of its size, a quarter … as they are needed.
class Reduced {
 public:
  explicit Reduced(const cv::Mat& image) : image_(image) {}

  /// Where it is as smooth, at so small a size that the kernel stays small: reducing by a factor k and
  /// enlarging again make a square of the blur's variance whose side is k / 2.
  cv::Mat blurred(double variance_px2) {
    constexpr double kWidestKernel_px = 12, kLeast_px2 = 0.25;
    int level = 1;
    while (std::sqrt(variance_px2) > kWidestKernel_px * (1 << level)) ++level;
    const double factor = 1 << level;
    const double sigma_px = std::sqrt(std::max(kLeast_px2, variance_px2 - factor * factor / 4)) / factor;
    cv::Mat soft, result;
    cv::GaussianBlur(at(level), soft, {}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
    cv::resize(soft, result, image_.size(), 0, 0, cv::INTER_LINEAR);
    return result;
  }

 private:
  const cv::Mat& at(int level) {
    if (level == 0) return image_;
    cv::Mat& reduced = by_level_[level];
    if (reduced.empty()) {
      const cv::Mat& larger = at(level - 1);
      cv::resize(larger, reduced, {(larger.cols + 1) / 2, (larger.rows + 1) / 2}, 0, 0, cv::INTER_AREA);
    }
    return reduced;
  }

  const cv::Mat& image_;
  std::map<int, cv::Mat> by_level_;
};

}  // namespace

cv::Mat bentLight(const cv::Mat& radiance, const CameraModel& camera, int bends) {
  const double bend_px2 = std::pow(camera.fx_px * kBend_rad, 2);
  Reduced reduced(radiance);
  if (bends > 1) return reduced.blurred(bends * bend_px2 / 3);
  cv::Mat mean = cv::Mat::zeros(radiance.size(), radiance.type());
  for (int place = 0; place < kPlaces; ++place)
    cv::scaleAdd(reduced.blurred(bend_px2 * std::pow((place + 0.5) / kPlaces, 2)), 1.0 / kPlaces, mean, mean);
  return mean;
}

}  // namespace fathom
