#include "image_files/image_file.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "image_files/bayer.h"

namespace fathom {
namespace {

using namespace std::string_view_literals;
constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegStart = "\xff\xd8\xff"sv, kJpegEnd = "\xff\xd9"sv;
constexpr std::string_view kBmpSignature = "BM"sv;
constexpr std::uint64_t kMostPixels = 100'000'000;  // cameras have a quarter of that
constexpr std::uint64_t kLongestSide_px = 65'535;   // JPEG's own limit

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

  /// Before anything is made room for.
  void checkSize(std::size_t at, std::uint64_t width, std::uint64_t height) const {
    if (width == 0 || height == 0) fail(at, "damaged: an image without a pixel");
    if (std::max(width, height) > kLongestSide_px || width * height > kMostPixels)
      fail(at, print("an image of %llu x %llu pixels: no more than 100 million are read",
                     static_cast<unsigned long long>(width), static_cast<unsigned long long>(height)));
  }

  void checkPng() const {
    const std::size_t first = kPngSignature.size();
    const std::uint64_t raw_bytes = checkPngHeader(first + 8);
    const std::uint64_t deflated_bytes = checkPngParts(first);
    constexpr std::uint64_t kMostInflation = 1032;  // deflate's limit
    if (raw_bytes > kMostInflation * deflated_bytes) fail(first + 8, "damaged: too few data for its size");
  }

  /// What libpng would refuse with lines of its own. The bytes that pixels and filters take.
  std::uint64_t checkPngHeader(std::size_t at) const {
    if (bytes_.size() < at + 13) fail(bytes_.size(), "the PNG image is cut off");
    if (bytes_.substr(at - 4, 4) != "IHDR") fail(at - 4, "damaged: a PNG image begins with its header");
    const std::uint64_t width = bigEndian(bytes_.substr(at, 4)), height = bigEndian(bytes_.substr(at + 4, 4));
    checkSize(at, width, height);
    const std::string_view depths[] = {"\1\2\4\x8\x10"sv, "", "\x8\x10"sv, "\1\2\4\x8"sv,
                                       "\x8\x10"sv,       "", "\x8\x10"sv};
    const std::uint64_t channels[] = {1, 0, 3, 1, 2, 0, 4};
    const auto colour = static_cast<std::uint8_t>(bytes_[at + 9]);
    const bool known =
        colour < std::size(depths) && depths[colour].find(bytes_[at + 8]) != std::string_view::npos;
    if (!known || bytes_[at + 10] != 0 || bytes_[at + 11] != 0 ||
        static_cast<std::uint8_t>(bytes_[at + 12]) > 1)
      fail(at + 8, "damaged: no such kind of PNG image");
    const auto depth = static_cast<std::uint64_t>(bytes_[at + 8]);
    return height * ((width * depth * channels[colour] + 7) / 8 + 1);
  }

  /// The bytes of pixels, deflated.
  std::uint64_t checkPngParts(std::size_t at) const {
    std::uint64_t deflated_bytes = 0;
    while (true) {  // length, type, data, checksum over type and data
      if (bytes_.size() - at < 12) fail(bytes_.size(), "the PNG image is cut off");
      const std::size_t length = bigEndian(bytes_.substr(at, 4));
      if (length > bytes_.size() - at - 12) fail(bytes_.size(), "the PNG image is cut off");
      const std::string_view body = bytes_.substr(at + 4, length + 4);
      const auto checksum =
          crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
      if (checksum != bigEndian(bytes_.substr(at + 8 + length, 4)))
        fail(at, "damaged: the checksum of this part of the PNG image is wrong");
      if (body.starts_with("IDAT")) deflated_bytes += length;
      if (body.starts_with("IEND")) return deflated_bytes;
      at += length + 12;
    }
  }

  /// Segments up to the first scan, then its end marker: within coded data 0xff is always followed by 0.
  void checkJpeg() const {
    std::size_t at = 2;
    while (true) {
      if (bytes_.size() - at < 4) fail(bytes_.size(), "the JPEG image is cut off");
      if (bytes_[at] != '\xff') fail(at, "damaged: no JPEG segment here");
      if (bytes_[at + 1] == '\xff') {  // a fill byte, of which there may be any number (ITU T.81, B.1.1.2)
        ++at;
        continue;
      }
      const auto kind = static_cast<std::uint8_t>(bytes_[at + 1]);
      const bool scan = kind == 0xda;
      const std::size_t length = bigEndian(bytes_.substr(at + 2, 2));
      if (length < 2 || length > bytes_.size() - at - 2) fail(bytes_.size(), "the JPEG image is cut off");
      if (isFrame(kind) && length >= 7)
        checkSize(at, bigEndian(bytes_.substr(at + 7, 2)), bigEndian(bytes_.substr(at + 5, 2)));
      at += length + 2;
      if (scan) break;
    }
    if (bytes_.find(kJpegEnd, at) == std::string_view::npos) fail(bytes_.size(), "the JPEG image is cut off");
  }

  /// ITU T.81, table B.1: start of frame; c4, c8 and cc are other things.
  static bool isFrame(std::uint8_t kind) {
    return kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc;
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
    checkSize(18, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(std::abs(height)));
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
    image = cv::imdecode(encoded, cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
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
  if (camera.bayer != BayerPattern::none && image.channels() != 1)
    throw Error(file.string(), "", "has colours; a raw image, as its camera's are, has one channel");
  return demosaiced(image, camera.bayer);
}

}  // namespace fathom
