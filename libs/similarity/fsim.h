#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>

/// FSIM, how alike two images look: Zhang, Zhang, Mou & Zhang, "FSIM: A Feature Similarity Index for Image
/// Quality Assessment", IEEE Transactions on Image Processing 20(8), 2011, with their constants. Where the
/// paper is silent, as the authors' published values have it.
namespace fathom {

class PhaseCongruency;

/// From 0 to 1, which it is for an image and itself, exactly. Symmetric.
struct FsimScore {
  double fsim = 0;   ///< of luminance
  double fsimc = 0;  ///< of luminance and colour
};

/// What FSIM compares of an image, reduced to about 256 pixels along its shorter side. All CV_32FC1, of one
/// size.
struct FsimFeatures {
  cv::Size image_size;           ///< of the image as it came
  cv::Mat phase_congruency;      ///< 0 to 1
  cv::Mat gradient_magnitude;    ///< Scharr's, digital numbers a pixel
  cv::Mat in_phase, quadrature;  ///< the colour: I and Q of YIQ, digital numbers
};

/// An image's features, and the score of two. Filters are made once for each size of image and kept.
/// One object may be shared by threads; results do not depend on what it did before.
class FsimComparer {
 public:
  /// The coarsest filter's wave must fit in.
  static constexpr int kLeastSide_px = 48;

  FsimComparer();
  ~FsimComparer();
  FsimComparer(const FsimComparer&) = delete;
  FsimComparer& operator=(const FsimComparer&) = delete;

  /// Why images cannot be compared (empty, type, too small, another size than the other), or nothing.
  static std::optional<std::string> whyNot(const cv::Mat& image);
  static std::optional<std::string> whyNot(const cv::Mat& reference, const cv::Mat& image);

  /// Of an image, BGR or gray, of 8 bits or of 16, these by the range that is used (imaging/eight_bits.h).
  /// Throws std::invalid_argument with whyNot().
  FsimFeatures features(const cv::Mat& image) const;

  /// Nothing where neither image has any feature, e.g. two plain ones. To compare one image with many, keep
  /// its features: they are what takes the time. Two images of 16 bits are seen by the range that both use.
  /// Throws std::invalid_argument for images of two sizes.
  static std::optional<FsimScore> compare(const FsimFeatures& reference, const FsimFeatures& image);
  std::optional<FsimScore> compare(const cv::Mat& reference, const cv::Mat& image) const;

 private:
  std::shared_ptr<const PhaseCongruency> congruencyFor(const cv::Size& size) const;

  mutable std::mutex mutex_;
  mutable std::map<std::pair<int, int>, std::shared_ptr<const PhaseCongruency>> congruencies_;
};

}  // namespace fathom
