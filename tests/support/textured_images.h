#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/random.h"

/// Images with something to see, for what compares images.
namespace fathom::test {

/// Coloured rectangles and circles of all sizes, edges a little soft. CV_8UC3.
inline cv::Mat texturedImage(const cv::Size& size, std::uint64_t seed) {
  Random random(seed);
  const auto below = [&](int end) { return static_cast<int>(random.uniform(0, end)); };
  cv::Mat image(size, CV_8UC3, cv::Scalar(90, 110, 70));
  for (int i = 0; i < 60; ++i) {
    const cv::Scalar colour(20 + below(200), 20 + below(200), 20 + below(200));
    const cv::Point at(below(size.width), below(size.height));
    const int extent = 3 + below(size.height / 6);
    if (i % 2 == 0)
      cv::circle(image, at, extent, colour, cv::FILLED);
    else
      cv::rectangle(image, cv::Rect(at, cv::Size(2 * extent, extent)), colour, cv::FILLED);
  }
  cv::GaussianBlur(image, image, {0, 0}, 0.7);
  return image;
}

/// With white noise of so many digital numbers, clipped and rounded.
inline cv::Mat noisy(const cv::Mat& image, double sigma, std::uint64_t seed) {
  Random random(seed);
  cv::Mat result = image.clone();
  for (int v = 0; v < result.rows; ++v)
    for (int u = 0; u < result.cols; ++u)
      for (int c = 0; c < 3; ++c) {
        auto& value = result.at<cv::Vec3b>(v, u)[c];
        value = cv::saturate_cast<std::uint8_t>(value + sigma * random.normal());
      }
  return result;
}

inline cv::Mat blurred(const cv::Mat& image, double sigma_px) {
  cv::Mat result;
  cv::GaussianBlur(image, result, {0, 0}, sigma_px);
  return result;
}

}  // namespace fathom::test
