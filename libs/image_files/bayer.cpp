#include "image_files/bayer.h"

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace fathom {
namespace {

int conversionOf(BayerPattern pattern) {
  switch (pattern) {
    case BayerPattern::rggb:
      return cv::COLOR_BayerRGGB2BGR;
    case BayerPattern::grbg:
      return cv::COLOR_BayerGRBG2BGR;
    case BayerPattern::gbrg:
      return cv::COLOR_BayerGBRG2BGR;
    default:
      return cv::COLOR_BayerBGGR2BGR;
  }
}

template <class Number>
cv::Mat measuredOf(const cv::Mat& image_bgr, BayerPattern pattern) {
  cv::Mat raw(image_bgr.size(), CV_MAKETYPE(image_bgr.depth(), 1));
  for (int v = 0; v < raw.rows; ++v)
    for (int u = 0; u < raw.cols; ++u) {
      const int channel = 2 - colourAt(pattern, u, v);
      raw.at<Number>(v, u) = image_bgr.at<cv::Vec<Number, 3>>(v, u)[channel];
    }
  return raw;
}

}  // namespace

cv::Mat mosaic(const cv::Mat& image_bgr, BayerPattern pattern) {
  if (pattern == BayerPattern::none || image_bgr.channels() == 1) return image_bgr;
  return image_bgr.depth() == CV_16U ? measuredOf<std::uint16_t>(image_bgr, pattern)
                                     : measuredOf<std::uint8_t>(image_bgr, pattern);
}

cv::Mat demosaiced(const cv::Mat& raw, BayerPattern pattern) {
  if (pattern == BayerPattern::none) return raw;
  if (raw.channels() != 1) throw std::invalid_argument("a raw image has one channel");
  cv::Mat image;
  cv::cvtColor(raw, image, conversionOf(pattern));
  return image;
}

}  // namespace fathom
