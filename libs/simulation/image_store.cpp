#include "simulation/image_store.h"

#include <zlib.h>

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "core/files.h"
#include "image_files/encode_image.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kInputs = "inputs.txt";

bool isDigits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// A name that imageFiles() gives, or such a file's unfinished part.
bool isOurs(std::string name) {
  const auto cut = [&](std::string_view ending) {
    if (!name.ends_with(ending)) return false;
    name.resize(name.size() - ending.size());
    return true;
  };
  cut(".part");
  if (!cut(".png") && !cut(".jpg")) return false;
  if (name.starts_with("CAMERA_")) return isDigits(name.substr(7));
  return name.starts_with("STEREO_") && (cut("_left") || cut("_right")) && isDigits(name.substr(7));
}

std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

/// PNG specification, 5: a signature, then chunks (length, type, data, CRC-32 of type and data) up to IEND.
bool isWholePng(const std::string& bytes) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::size_t kFrame = 12;  // a chunk's bytes besides its data
  if (!bytes.starts_with(kSignature)) return false;
  for (std::size_t at = kSignature.size(); at + kFrame <= bytes.size();) {
    const std::size_t length = bigEndian(bytes, at);
    if (length > bytes.size() - at - kFrame) return false;
    const auto* type = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    if (crc32(0, type, static_cast<uInt>(length + 4)) != bigEndian(bytes, at + 8 + length)) return false;
    if (bytes.compare(at + 4, 4, "IEND") == 0) return at + kFrame + length == bytes.size();
    at += kFrame + length;
  }
  return false;
}

/// ITU T.81, annex B: start of image, a marker behind it, and at the very end the end of image.
bool isWholeJpeg(const std::string& bytes) {
  return bytes.size() > 5 && bytes.starts_with("\xff\xd8\xff") && bytes.ends_with("\xff\xd9");
}

}  // namespace

ImageStore::ImageStore(fs::path folder, const std::string& inputs, const ImageFormat& format)
    : folder_(std::move(folder)), format_(format) {
  const fs::path inputs_file = folder_ / kInputs;
  const bool same = isThere(inputs_file) && readTextFile(inputs_file) == inputs;
  std::error_code problem;
  if (!same) fs::remove(inputs_file, problem);  // first: images without it belong to nothing
  if (isFolder(folder_))
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const bool stale =
          isOurs(entry.path().filename().string()) && (!same || entry.path().extension() == ".part");
      if (stale && !fs::remove(entry.path(), problem))
        throw Error(entry.path().string(), "", "cannot be removed: " + problem.message());
    }
  if (!same) writeTextFile(inputs_file, inputs);
}

bool ImageStore::has(const std::string& file) const {
  if (!isThere(folder_ / file)) return false;
  const std::string bytes = readTextFile(folder_ / file);
  return format_.kind == ImageFormat::Kind::png ? isWholePng(bytes) : isWholeJpeg(bytes);
}

void ImageStore::write(const std::string& file, const cv::Mat& image_bgr) const {
  const bool png = format_.kind == ImageFormat::Kind::png;
  writeTextFile(folder_ / file, png ? pngBytes(image_bgr) : jpegBytes(image_bgr, format_.jpeg_quality));
}

}  // namespace fathom
