#include "fiducials/preprocess.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "imaging/eight_bits.h"
#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr double kClipLimit = 3.0;
constexpr int kTile_px = 80;

/// The gray value that a share of the pixels stays below.
double percentile(const std::array<int, 256>& histogram, double share) {
  double count = 0;
  for (const int n : histogram) count += n;
  double below = 0;
  for (std::size_t value = 0; value < histogram.size(); ++value) {
    below += histogram[value];
    if (below >= share * count) return static_cast<double>(value);
  }
  return 255.0;
}

GrayRange rangeOf(const cv::Mat& gray) {
  std::array<int, 256> histogram{};
  for (int row = 0; row < gray.rows; ++row)
    for (int column = 0; column < gray.cols; ++column) ++histogram[gray.at<std::uint8_t>(row, column)];
  return {percentile(histogram, 0.01), percentile(histogram, 0.99)};
}

cv::Mat stretched(const cv::Mat& gray, const GrayRange& range) {
  const double width = std::max(1.0, range.white - range.black);
  const double black = range.black - 0.1 * width, gain = 255.0 / (1.2 * width);
  cv::Mat result;
  gray.convertTo(result, CV_8U, gain, -gain * black);
  return result;
}

}  // namespace

std::string_view nameOf(Preprocess preprocess) {
  switch (preprocess) {
    case Preprocess::none:
      return "none";
    case Preprocess::stretch:
      return "stretch";
    case Preprocess::clahe:
      return "clahe";
  }
  return "";
}

GrayRange expectedRange(const Vector3d& black_radiance, const Vector3d& white_radiance, const Water& water,
                        const CameraSheet& sheet, double range_m) {
  const Vector3d weights(0.299, 0.587, 0.114);  // as cv::COLOR_BGR2GRAY
  const ResponseCurve<double> curve{sheet.response_gamma};
  const auto gray = [&](const Vector3d& radiance) {
    const Vector3d light = predictLight<double>(radiance, range_m, range_m, water, {});
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += 255.0 * weights[c] * predictReading(light[c], {}, curve, c);
    return sum;
  };
  return {gray(black_radiance), gray(white_radiance)};
}

cv::Mat toGray(const cv::Mat& image) {
  if (image.empty()) throw std::invalid_argument("the image is empty");
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    throw std::invalid_argument("the image is neither of 8 bits nor of 16");
  if (image.channels() == 1) return inEightBits(image);
  if (image.channels() != 3) throw std::invalid_argument("the image is neither gray nor BGR");
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return inEightBits(gray);
}

cv::Mat preprocessed(const cv::Mat& gray, Preprocess preprocess, const GrayRange* range) {
  if (preprocess == Preprocess::none) return gray;
  if (preprocess == Preprocess::stretch) return stretched(gray, range != nullptr ? *range : rangeOf(gray));
  const cv::Size tiles(std::max(1, gray.cols / kTile_px), std::max(1, gray.rows / kTile_px));
  cv::Mat result;
  cv::createCLAHE(kClipLimit, tiles)->apply(gray, result);
  return result;
}

}  // namespace fathom
