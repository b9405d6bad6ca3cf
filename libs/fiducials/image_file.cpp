#include "fiducials/image_file.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"

namespace fathom {
namespace {

using namespace std::string_view_literals;
constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegStart = "\xff\xd8\xff"sv, kJpegEnd = "\xff\xd9"sv;
constexpr std::string_view kBmpSignature = "BM"sv;

std::uint32_t bigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes) value = value << 8U | static_cast<std::uint8_t>(byte);
  return value;
}

std::uint32_t littleEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (auto byte = bytes.rbegin(); byte != bytes.rend(); ++byte)
    value = value << 8U | static_cast<std::uint8_t>(*byte);
  return value;
}

/// Decoders fill what is missing of a truncated image with gray and say nothing, so the container is walked
/// here first.
class Checker {
 public:
  Checker(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {}

  void check() const {
    if (bytes_.empty()) throw Error(file_, "", "the file is empty");
    if (bytes_.starts_with(kPngSignature)) return checkPng();
    if (bytes_.starts_with(kJpegStart)) return checkJpeg();
    if (bytes_.starts_with(kBmpSignature)) return checkBmp();
    throw Error(file_, "", "neither a PNG nor a JPEG nor a BMP image");
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& why) const {
    throw Error(file_, "byte " + std::to_string(at), why);
  }

  void checkPng() const {
    std::size_t at = kPngSignature.size();
    while (true) {  // length, type, data, checksum over type and data
      if (bytes_.size() - at < 12) fail(bytes_.size(), "the PNG image is cut off");
      const std::size_t length = bigEndian(bytes_.substr(at, 4));
      if (length > bytes_.size() - at - 12) fail(bytes_.size(), "the PNG image is cut off");
      const std::string_view body = bytes_.substr(at + 4, length + 4);
      const auto checksum =
          crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
      if (checksum != bigEndian(bytes_.substr(at + 8 + length, 4)))
        fail(at, "damaged: the checksum of this part of the PNG image is wrong");
      if (body.starts_with("IEND")) return;
      at += length + 12;
    }
  }

  /// Segments up to the first scan, then its end marker: within coded data 0xff is always followed by 0.
  void checkJpeg() const {
    std::size_t at = 2;
    while (true) {
      if (bytes_.size() - at < 4) fail(bytes_.size(), "the JPEG image is cut off");
      if (bytes_[at] != '\xff') fail(at, "damaged: no JPEG segment here");
      const bool scan = bytes_[at + 1] == '\xda';
      const std::size_t length = bigEndian(bytes_.substr(at + 2, 2));
      if (length < 2 || length > bytes_.size() - at - 2) fail(bytes_.size(), "the JPEG image is cut off");
      at += length + 2;
      if (scan) break;
    }
    if (bytes_.find(kJpegEnd, at) == std::string_view::npos) fail(bytes_.size(), "the JPEG image is cut off");
  }

  /// Pixels lie in rows of whole words from an offset on; a negative height means from the top.
  void checkBmp() const {
    constexpr std::size_t header = 54;
    if (bytes_.size() < header) fail(bytes_.size(), "the BMP image is cut off");
    const auto field = [this](std::size_t at, std::size_t size) {
      return littleEndian(bytes_.substr(at, size));
    };
    if (const auto compression = field(30, 4); compression != 0 && compression != 3)
      fail(30, "the BMP image is compressed; only plain ones are read");
    const std::int64_t offset = field(10, 4), width = static_cast<std::int32_t>(field(18, 4)),
                       height = static_cast<std::int32_t>(field(22, 4)), bits = field(28, 2);
    const std::int64_t row_bytes = (width * bits + 31) / 32 * 4;
    if (width <= 0 || height == 0 || bits == 0 || bits > 32)
      fail(18, "damaged: the BMP image's size or depth cannot be");
    const auto rows_there = (static_cast<std::int64_t>(bytes_.size()) - offset) / row_bytes;
    if (std::abs(height) > rows_there) fail(bytes_.size(), "the BMP image is cut off");
  }

  std::string file_;
  std::string_view bytes_;
};

}  // namespace

cv::Mat readImage(const std::filesystem::path& file) {
  const std::string bytes = readTextFile(file);
  Checker(file.string(), bytes).check();
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    image = cv::imdecode(encoded, cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& fault) {
    throw Error(file.string(), "", "cannot be decoded: " + fault.err);
  }
  if (image.empty()) throw Error(file.string(), "", "cannot be decoded");
  return image;
}

cv::Mat readImage(const std::filesystem::path& file, const CameraModel& camera) {
  cv::Mat image = readImage(file);
  if (image.cols != camera.width_px || image.rows != camera.height_px)
    throw Error(file.string(), "",
                print("is of %d x %d pixels, its camera of %d x %d", image.cols, image.rows, camera.width_px,
                      camera.height_px));
  return image;
}

}  // namespace fathom
