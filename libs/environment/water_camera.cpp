#include "environment/water_camera.h"

#include <numeric>
#include <opencv2/imgcodecs.hpp>

#include "core/files.h"

namespace fathom {
namespace {

// Far from the streams of recordings' noise, and of the pairs'.
std::uint64_t noiseStream(std::size_t image) { return std::uint64_t{3} << 61 | image; }

// Of the luminance table that the JPEG standard suggests (ITU-T T.81, table K.1), which libjpeg scales.
constexpr int kStandardSum = 3688;

CameraSheet ofEightBits(CameraSheet sheet, const CameraModel& model) {
  sheet.bits = 8;
  sheet.model = model;
  return sheet;
}

}  // namespace

WaterCamera::WaterCamera(CameraSheet sheet, const CameraModel& model, std::optional<int> jpeg_quality,
                         std::uint64_t seed)
    : sheet_(ofEightBits(std::move(sheet), model)),
      model_(sheet_, Water{}),
      jpeg_quality_(jpeg_quality),
      seed_(seed) {}

cv::Mat WaterCamera::image(const View& clean, const Environment& environment, std::size_t number,
                           double log_gain) const {
  const Vector3d& ambient = environment.ambient;
  const cv::Mat scene = clean.radiance.mul(cv::Scalar(ambient[0], ambient[1], ambient[2]));
  Random noise = Random::stream(seed_, noiseStream(number));
  const cv::Mat light = model_.in(environment.water).light(scene, clean.range_m) * std::exp(log_gain);
  cv::Mat image = model_.expose(light, &noise);
  if (!jpeg_quality_) return image;
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, *jpeg_quality_});
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

std::optional<int> jpegQuality(const std::filesystem::path& file) {
  const std::string bytes = readTextFile(file);
  const auto byte = [&](std::size_t at) { return static_cast<int>(static_cast<unsigned char>(bytes[at])); };
  if (bytes.size() < 4 || byte(0) != 0xff || byte(1) != 0xd8) return std::nullopt;
  // Segments, each 0xff, kind, length; that of tables (0xdb) begins with the luminance table's number, 0.
  for (std::size_t at = 2; at + 4 < bytes.size() && byte(at) == 0xff;) {
    const auto length = 256 * static_cast<std::size_t>(byte(at + 2)) + static_cast<std::size_t>(byte(at + 3));
    if (byte(at + 1) == 0xdb && byte(at + 4) == 0 && at + 69 <= bytes.size()) {
      int sum = 0;
      for (std::size_t i = 0; i < 64; ++i) sum += byte(at + 5 + i);
      const double percent = 100.0 * sum / kStandardSum;
      const double quality = percent > 100 ? 5000 / percent : (200 - percent) / 2;
      return std::clamp(static_cast<int>(std::lround(quality)), 1, 100);
    }
    at += 2 + length;
  }
  return std::nullopt;
}

}  // namespace fathom
