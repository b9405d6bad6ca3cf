#pragma once

#include <cstdint>
#include <optional>

#include "sil/pair_maker.h"

namespace fathom {

/// What the recording's camera would have recorded in some water: like is compared with like, so with the
/// effects of the maker's world, with the sensor's noise, and by way of JPEG where the recording's images are
/// JPEG. For many threads at once; the maker outlives it.
class WaterCamera {
 public:
  /// `jpeg_quality` absent: the images are exact.
  WaterCamera(const PairMaker& maker, std::optional<int> jpeg_quality, std::uint64_t seed)
      : maker_(maker), jpeg_quality_(jpeg_quality), seed_(seed) {}

  const CameraSheet& sheet() const { return maker_.camera(); }
  /// CV_8UC3, of the view that the maker has of a posed image. The noise depends on the seed and the image's
  /// number only, and is the same in every water.
  cv::Mat image(const PosedImage& posed, const View& clean, const Environment& environment,
                double log_gain = 0) const;

 private:
  const PairMaker& maker_;
  std::optional<int> jpeg_quality_;
  std::uint64_t seed_;
};

}  // namespace fathom
