#include "imaging/eight_bits.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fathom {
namespace {

constexpr double kFullScale16 = 65535, kLevels8 = 255;
constexpr double kOutliers = 1e-4;  // of all pixels, at each end

std::vector<std::size_t> histogramOf(const cv::Mat& image) {
  std::vector<std::size_t> histogram(65536);
  for (int row = 0; row < image.rows; ++row) {
    const auto* numbers = image.ptr<std::uint16_t>(row);
    for (int i = 0; i < image.cols * image.channels(); ++i) ++histogram[numbers[i]];
  }
  return histogram;
}

/// How many of these come before there are more than so many.
template <class Iterator>
double levelsBefore(Iterator begin, Iterator end, double outliers) {
  double seen = 0;
  const auto first = std::find_if(
      begin, end, [&](std::size_t count) { return (seen += static_cast<double>(count)) > outliers; });
  return static_cast<double>(first - begin);
}

}  // namespace

LevelRange usedRange(const cv::Mat& image) {
  const auto histogram = histogramOf(image);
  const double outliers = kOutliers * static_cast<double>(image.total()) * image.channels();
  const double black = levelsBefore(histogram.begin(), histogram.end(), outliers);
  const double white = kFullScale16 - levelsBefore(histogram.rbegin(), histogram.rend(), outliers);
  if (white - black >= kFullScale16 / 2) return {};
  return {black, std::max(white, black + kLevels8)};
}

LevelRange joined(const LevelRange& a, const LevelRange& b) {
  return {std::min(a.black, b.black), std::max(a.white, b.white)};
}

cv::Mat inEightBits(const cv::Mat& image, const LevelRange& range) {
  if (image.depth() != CV_16U) return image;
  const double gain = kLevels8 / (range.white - range.black);
  cv::Mat result;
  image.convertTo(result, CV_8U, gain, -gain * range.black);
  return result;
}

cv::Mat inEightBits(const cv::Mat& image) {
  return image.depth() == CV_16U ? inEightBits(image, usedRange(image)) : image;
}

int bitsOf(const cv::Mat& image, int sheet_bits) {
  if (image.depth() != CV_16U) return 8;
  double brightest = 0;
  cv::minMaxLoc(image.reshape(1), nullptr, &brightest);
  return brightest < (1 << sheet_bits) ? sheet_bits : 16;
}

cv::Mat fullScaleInEightBits(const cv::Mat& image, int sheet_bits) {
  return inEightBits(image, {0, static_cast<double>((1 << bitsOf(image, sheet_bits)) - 1)});
}

}  // namespace fathom
