#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <opencv2/core.hpp>
#include <set>

#include "audit/checks.h"
#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/text.h"
#include "image_files/image_file.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {
using enum Finding::Certainty;

/// How far apart an image's gray levels are: cameras of fewer than 16 bits leave out the lowest ones, or
/// repeat the highest in them (times 257).
int grayLevel(const cv::Mat& image) {
  if (image.depth() != CV_16U) return 1;
  constexpr int kCoarsest = 257;
  int level = 0;
  for (int row = 0; row < image.rows && level != 1; ++row) {
    const auto* numbers = image.ptr<std::uint16_t>(row);
    for (int i = 0; i < image.cols * image.channels(); ++i) level = std::gcd(level, int{numbers[i]});
  }
  return std::clamp(level, 1, kCoarsest);
}

class ImageCheck {
 public:
  ImageCheck(const std::string& label, const ImageStream& stream, fs::path folder,
             std::vector<Finding>& findings)
      : label_(label), stream_(stream), folder_(std::move(folder)), findings_(findings) {}

  void check() {
    const std::size_t count = std::min(kMostImagesRead, stream_.files.size());
    for (std::size_t i = 0; i < count; ++i) look(i * stream_.files.size() / count);
    if (other_size_ > 0) {
      const CameraModel& m = stream_.intrinsics.model;
      add("image-size", sure,
          print("%zu of %zu images looked at are %d x %d px, the camera is %d x %d", other_size_, looked_at_,
                size_.width, size_.height, m.width_px, m.height_px));
    }
    const auto many = [&](std::size_t n) { return n * 5 > looked_at_ && n > 1; };
    if (many(blank_))
      add("images-blank", 2 * blank_ > looked_at_ ? sure : likely,
          print("%zu of %zu images looked at show nothing: all pixels within %g of their gray levels", blank_,
                looked_at_, kBlank));
    else if (many(repeated_))
      add("images-repeated", likely,
          print("%zu of %zu images looked at are, byte for byte, the one before", repeated_, looked_at_));
  }

 private:
  static constexpr double kBlank = 2;

  void add(const std::string& name, Finding::Certainty certainty, std::string what) {
    findings_.push_back(finding(name, label_, Instance::of(label_), certainty, std::move(what)));
  }

  /// An image, and whether it is the one before again. What cannot be read is told elsewhere.
  void look(std::size_t i) try {
    const cv::Mat image = readImage(folder_ / stream_.files[i]);
    ++looked_at_;
    const CameraModel& m = stream_.intrinsics.model;
    if (image.cols != m.width_px || image.rows != m.height_px) ++other_size_, size_ = image.size();
    double darkest = 0, brightest = 0;
    cv::minMaxLoc(image.reshape(1), &darkest, &brightest);
    if (brightest - darkest <= kBlank * grayLevel(image)) ++blank_;
    if (i > 0 && readTextFile(folder_ / stream_.files[i]) == readTextFile(folder_ / stream_.files[i - 1]))
      ++repeated_;
  } catch (const Error&) {
  }

  const std::string label_;
  const ImageStream& stream_;
  const fs::path folder_;
  std::vector<Finding>& findings_;
  std::size_t looked_at_ = 0, other_size_ = 0, blank_ = 0, repeated_ = 0;
  cv::Size size_;
};

}  // namespace

void checkImages(const Streams& streams, const fs::path& image_folder, std::vector<Finding>& findings) {
  for (const auto& [label, stream] : streams.images)
    ImageCheck(label, stream, image_folder, findings).check();
}

}  // namespace fathom
