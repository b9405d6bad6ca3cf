#include "image_files/encode_image.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <vector>

namespace fathom {
namespace {

std::uint8_t displayed(float radiance) {
  const float light = std::clamp(radiance, 0.0f, 1.0f);
  const float curve = light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * curve));
}

std::string bytesOf(const cv::Mat& image, const char* extension, const std::vector<int>& parameters) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(extension, image, bytes, parameters))
    throw std::invalid_argument("an image that cannot be encoded");
  return {bytes.begin(), bytes.end()};
}

}  // namespace

cv::Mat toDisplay(const cv::Mat& radiance) {
  if (radiance.type() != CV_32FC3) throw std::invalid_argument("a radiance image is CV_32FC3");
  cv::Mat display(radiance.size(), CV_8UC3);
  for (int row = 0; row < display.rows; ++row)
    for (int column = 0; column < display.cols; ++column) {
      const auto& rgb = radiance.at<cv::Vec3f>(row, column);
      display.at<cv::Vec3b>(row, column) = {displayed(rgb[2]), displayed(rgb[1]), displayed(rgb[0])};
    }
  return display;
}

std::string pngBytes(const cv::Mat& image) { return bytesOf(image, ".png", {}); }

std::string jpegBytes(const cv::Mat& image, int quality) {
  return bytesOf(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

}  // namespace fathom
