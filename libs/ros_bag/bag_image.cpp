#include "ros_bag/bag_image.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr int kAsItIs = -1;

struct Encoding {
  int type;        ///< of OpenCV, of the raw data
  int conversion;  ///< to what a PNG has: gray or BGR
};

/// Some drivers write them in capitals.
struct AnyCase {
  bool operator()(const std::string& a, const std::string& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
      return std::tolower(static_cast<unsigned char>(x)) < std::tolower(static_cast<unsigned char>(y));
    });
  }
};

/// As ROS names them (sensor_msgs/image_encodings.h). OpenCV names a Bayer pattern by its second row, ROS by
/// its first.
const std::map<std::string, Encoding, AnyCase>& encodings() {
  static const std::map<std::string, Encoding, AnyCase> known{
      {"mono8", {CV_8UC1, kAsItIs}},
      {"8UC1", {CV_8UC1, kAsItIs}},
      {"bgr8", {CV_8UC3, kAsItIs}},
      {"8UC3", {CV_8UC3, kAsItIs}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"8UC4", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"mono16", {CV_16UC1, kAsItIs}},
      {"16UC1", {CV_16UC1, kAsItIs}},
      {"bgr16", {CV_16UC3, kAsItIs}},
      {"16UC3", {CV_16UC3, kAsItIs}},
      {"rgb16", {CV_16UC3, cv::COLOR_RGB2BGR}},
      {"bgra16", {CV_16UC4, cv::COLOR_BGRA2BGR}},
      {"16UC4", {CV_16UC4, cv::COLOR_BGRA2BGR}},
      {"rgba16", {CV_16UC4, cv::COLOR_RGBA2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}},
      {"bayer_rggb16", {CV_16UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr16", {CV_16UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg16", {CV_16UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg16", {CV_16UC1, cv::COLOR_BayerGB2BGR}}};
  return known;
}

/// With this machine's order of bytes.
cv::Mat inOwnOrder(const cv::Mat& raw, bool is_bigendian) {
  const bool is_own = is_bigendian == (std::endian::native == std::endian::big);
  if (raw.depth() != CV_16U || is_own) return raw;
  cv::Mat swapped(raw.rows, raw.cols, raw.type());
  for (int v = 0; v < raw.rows; ++v)
    std::transform(raw.ptr<std::uint16_t>(v), raw.ptr<std::uint16_t>(v) + raw.cols * raw.channels(),
                   swapped.ptr<std::uint16_t>(v),
                   [](std::uint16_t x) { return static_cast<std::uint16_t>(x << 8 | x >> 8); });
  return swapped;
}

}  // namespace

int bitsOf(const std::string& encoding) {
  const auto found = encodings().find(encoding);
  return found != encodings().end() && CV_MAT_DEPTH(found->second.type) == CV_16U ? 16 : 8;
}

std::vector<unsigned char> encodePng(const ros1::Image& image, const BagMessage& message) {
  const auto found = encodings().find(image.encoding);
  if (found == encodings().end()) {
    std::string known;
    for (const auto& [name, encoding] : encodings()) known += (known.empty() ? "" : ", ") + name;
    throw message.error("image encoding `" + image.encoding + "` is not known (" + known + " are)");
  }
  const auto& [type, conversion] = found->second;
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * CV_ELEM_SIZE(type);
  if (image.width == 0 || image.height == 0 || image.step < row_bytes ||
      image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw message.error("image data does not fit its width, height and step");
  if (CV_MAT_CN(type) == 2 && image.width % 2 != 0)
    throw message.error("image of pairs of pixels has an odd width");
  auto* pixels = const_cast<unsigned char*>(image.data.data());  // cv::Mat has no view of constant data
  const cv::Mat raw(static_cast<int>(image.height), static_cast<int>(image.width), type, pixels, image.step);
  cv::Mat picture = inOwnOrder(raw, image.is_bigendian != 0);
  if (conversion != kAsItIs) cv::cvtColor(picture, picture, conversion);
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", picture, png)) throw message.error("image cannot be encoded as PNG");
  return png;
}

std::string compressedExtension(const std::vector<unsigned char>& bytes, const BagMessage& message) {
  const auto starts = [&](std::initializer_list<unsigned char> magic) {
    return bytes.size() > magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts({0x89, 'P', 'N', 'G'})) return ".png";
  if (starts({0xFF, 0xD8, 0xFF})) return ".jpg";
  throw message.error("compressed image is neither PNG nor JPEG");
}

}  // namespace fathom
