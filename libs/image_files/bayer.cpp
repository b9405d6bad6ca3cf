#include "image_files/bayer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace fathom {
namespace {

/// The channel of a BGR image that a pixel measures: of even and odd rows, even and odd columns.
using Channels = std::array<std::array<int, 2>, 2>;
Channels channelsOf(BayerPattern pattern) {
  constexpr int kBlue = 0, kGreen = 1, kRed = 2;
  switch (pattern) {
    case BayerPattern::rggb:
      return {{{kRed, kGreen}, {kGreen, kBlue}}};
    case BayerPattern::grbg:
      return {{{kGreen, kRed}, {kBlue, kGreen}}};
    case BayerPattern::gbrg:
      return {{{kGreen, kBlue}, {kRed, kGreen}}};
    default:
      return {{{kBlue, kGreen}, {kGreen, kRed}}};
  }
}

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
cv::Mat measuredOf(const cv::Mat& image_bgr, const Channels& channels) {
  cv::Mat raw(image_bgr.size(), CV_MAKETYPE(image_bgr.depth(), 1));
  for (int v = 0; v < raw.rows; ++v)
    for (int u = 0; u < raw.cols; ++u) {
      const int channel = channels[static_cast<std::size_t>(v % 2)][static_cast<std::size_t>(u % 2)];
      raw.at<Number>(v, u) = image_bgr.at<cv::Vec<Number, 3>>(v, u)[channel];
    }
  return raw;
}

}  // namespace

cv::Mat mosaic(const cv::Mat& image_bgr, BayerPattern pattern) {
  if (pattern == BayerPattern::none || image_bgr.channels() == 1) return image_bgr;
  return image_bgr.depth() == CV_16U ? measuredOf<std::uint16_t>(image_bgr, channelsOf(pattern))
                                     : measuredOf<std::uint8_t>(image_bgr, channelsOf(pattern));
}

cv::Mat demosaiced(const cv::Mat& raw, BayerPattern pattern) {
  if (pattern == BayerPattern::none) return raw;
  if (raw.channels() != 1) throw std::invalid_argument("a raw image has one channel");
  cv::Mat image;
  cv::cvtColor(raw, image, conversionOf(pattern));
  return image;
}

}  // namespace fathom
