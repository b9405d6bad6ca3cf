#include "render/images.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fathom {
namespace {

std::uint8_t displayed(float radiance) {
  const float light = std::clamp(radiance, 0.0f, 1.0f);
  const float curve = light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * curve));
}

}  // namespace

cv::Mat depthAlongAxis(const cv::Mat& range_m, const CameraModel& camera) {
  if (range_m.type() != CV_32FC1 || range_m.size() != cv::Size(camera.width_px, camera.height_px))
    throw std::invalid_argument("a range image is CV_32FC1 and of the camera's size");
  cv::Mat depth_m(range_m.size(), CV_32FC1);
  for (int row = 0; row < depth_m.rows; ++row)
    for (int column = 0; column < depth_m.cols; ++column)
      depth_m.at<float>(row, column) =
          range_m.at<float>(row, column) * static_cast<float>(camera.rayAt(Vector2d(column, row)).z());
  return depth_m;
}

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

}  // namespace fathom
