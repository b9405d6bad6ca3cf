#include "sil/pair_picture.h"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/text.h"
#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr int kCaptionHeight_px = 26;
const cv::Vec3f kBrighterSimulated(0xb2, 0x72, 0x00), kSame(255, 255, 255),
    kBrighterRecorded(0x00, 0x5e, 0xd5);
const cv::Vec3b kNotCompared(128, 128, 128);

/// The luminance that a channel's numbers stand for: blue, green, red.
using LuminanceTables = std::array<std::array<float, 256>, 3>;

LuminanceTables luminanceTables(const CameraSheet& camera) {
  constexpr std::array<double, 3> kWeights{0.0722, 0.7152, 0.2126};  // Rec. ITU-R BT.709
  LuminanceTables tables;
  for (std::size_t c = 0; c < 3; ++c)
    for (int number = 0; number < 256; ++number)
      tables[c][static_cast<std::size_t>(number)] =
          static_cast<float>(kWeights[c] * radianceOf(number, camera));
  return tables;
}

cv::Vec3b colourOf(float residual, const ResidualScale& scale) {
  const float share = std::clamp(residual / static_cast<float>(scale.full_scale), -1.0F, 1.0F);
  const cv::Vec3f& end = share < 0 ? kBrighterSimulated : kBrighterRecorded;
  return cv::Vec3b(kSame + std::abs(share) * (end - kSame));
}

cv::Mat scaledTo(const cv::Mat& picture, int width_px) {
  if (width_px == 0 || width_px == picture.cols) return picture;
  cv::Mat result;
  const double scale = static_cast<double>(width_px) / picture.cols;
  cv::resize(picture, result, {width_px, static_cast<int>(std::lround(scale * picture.rows))}, 0, 0,
             scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

}  // namespace

cv::Mat luminanceResidual(const ImagePair& pair) {
  const LuminanceTables tables = luminanceTables(*pair.camera);
  cv::Mat residual(pair.recorded.size(), CV_32FC1);
  for (int v = 0; v < residual.rows; ++v) {
    const auto *recorded = pair.recorded.ptr(v), *simulated = pair.simulated.ptr(v);
    auto* row = residual.ptr<float>(v);
    for (int u = 0; u < residual.cols; ++u, recorded += 3, simulated += 3) {
      row[u] = 0;
      for (std::size_t c = 0; c < 3; ++c) row[u] += tables[c][recorded[c]] - tables[c][simulated[c]];
    }
  }
  return residual;
}

cv::Mat residualPicture(const ImagePair& pair, const cv::Mat& region, const ResidualScale& scale) {
  const cv::Mat residual = luminanceResidual(pair);
  cv::Mat picture(residual.size(), CV_8UC3);
  for (int v = 0; v < picture.rows; ++v)
    for (int u = 0; u < picture.cols; ++u)
      picture.at<cv::Vec3b>(v, u) =
          region.at<std::uint8_t>(v, u) == 0 ? kNotCompared : colourOf(residual.at<float>(v, u), scale);
  return picture;
}

cv::Mat brightenedForEye(const cv::Mat& image_bgr, const CameraSheet& camera) {
  cv::Mat table(1, 256, CV_8U), result;
  for (int i = 0; i < 256; ++i)
    table.at<std::uint8_t>(i) =
        cv::saturate_cast<std::uint8_t>(255.0 * std::pow(radianceOf(i, camera), 1 / 2.2));
  cv::LUT(image_bgr, table, result);
  return result;
}

std::vector<cv::Mat> pairTiles(const ImagePair& pair, const cv::Mat& region, const ResidualScale& scale,
                               int width_px) {
  return {scaledTo(brightenedForEye(pair.recorded, *pair.camera), width_px),
          scaledTo(brightenedForEye(pair.simulated, *pair.camera), width_px),
          scaledTo(residualPicture(pair, region, scale), width_px)};
}

cv::Mat pairPicture(const ImagePair& pair, const cv::Mat& region, const ResidualScale& scale,
                    const std::string& caption, int width_px) {
  cv::Mat picture;
  cv::hconcat(pairTiles(pair, region, scale, width_px), picture);
  cv::copyMakeBorder(picture, picture, 0, kCaptionHeight_px, 0, 0, cv::BORDER_CONSTANT,
                     cv::Scalar(255, 255, 255));
  cv::putText(picture, caption, {4, picture.rows - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(30, 30, 30),
              1, cv::LINE_AA);
  return picture;
}

std::string legendOf(const ResidualScale& scale) {
  return print("recorded | simulated | recorded - simulated, linear light: blue -%g, white 0, orange +%g",
               scale.full_scale, scale.full_scale);
}

}  // namespace fathom
