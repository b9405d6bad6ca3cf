#include "ros_bag/bag_image.h"

#include <algorithm>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

/// OpenCV names a Bayer pattern by its second row, ROS by its first.
cv::Mat toBgr(const cv::Mat& raw, const std::string& encoding) {
  static const std::map<std::string, int> kConversions{{"rgb8", cv::COLOR_RGB2BGR},
                                                       {"bayer_rggb8", cv::COLOR_BayerBG2BGR},
                                                       {"bayer_bggr8", cv::COLOR_BayerRG2BGR},
                                                       {"bayer_gbrg8", cv::COLOR_BayerGR2BGR},
                                                       {"bayer_grbg8", cv::COLOR_BayerGB2BGR}};
  const auto conversion = kConversions.find(encoding);
  if (conversion == kConversions.end()) return raw;
  cv::Mat bgr;
  cv::cvtColor(raw, bgr, conversion->second);
  return bgr;
}

}  // namespace

std::vector<unsigned char> encodePng(const ros1::Image& image, const BagMessage& message) {
  const std::string& encoding = image.encoding;
  const bool colour = encoding == "bgr8" || encoding == "rgb8";
  const bool bayer = encoding == "bayer_rggb8" || encoding == "bayer_bggr8" || encoding == "bayer_gbrg8" ||
                     encoding == "bayer_grbg8";
  if (!colour && !bayer && encoding != "mono8")
    throw message.error("image encoding `" + encoding + "` is not known (mono8, bgr8, rgb8, bayer_*8 are)");
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * (colour ? 3 : 1);
  if (image.width == 0 || image.height == 0 || image.step < row_bytes ||
      image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw message.error("image data does not fit its width, height and step");
  auto* pixels = const_cast<unsigned char*>(image.data.data());  // cv::Mat has no view of constant data
  const cv::Mat raw(static_cast<int>(image.height), static_cast<int>(image.width), colour ? CV_8UC3 : CV_8UC1,
                    pixels, image.step);
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", toBgr(raw, encoding), png)) throw message.error("image cannot be encoded as PNG");
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
