#include "image_files/jpeg.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "core/files.h"

namespace fathom {
namespace {

// Of the luminance table that the JPEG standard suggests (ITU-T T.81, table K.1), which libjpeg scales.
constexpr int kStandardSum = 3688;

}  // namespace

std::optional<int> jpegQuality(const std::filesystem::path& file) {
  const std::string bytes = readTextFile(file);
  const auto byte = [&](std::size_t at) { return static_cast<int>(static_cast<unsigned char>(bytes[at])); };
  if (bytes.size() < 4 || byte(0) != 0xff || byte(1) != 0xd8) return std::nullopt;
  // Segments, each 0xff, kind, length; that of tables (0xdb) begins with the luminance table's number, 0.
  for (std::size_t at = 2; at + 4 < bytes.size() && byte(at) == 0xff;) {
    if (byte(at + 1) == 0xff) {  // a fill byte
      ++at;
      continue;
    }
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

cv::Mat throughJpeg(const cv::Mat& image, std::optional<int> quality) {
  if (!quality) return image;
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, *quality});
  return cv::imdecode(bytes, cv::IMREAD_ANYCOLOR);
}

}  // namespace fathom
