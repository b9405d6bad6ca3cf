#pragma once

#include <cstdint>
#include <optional>

#include "sensors/image_model.h"
#include "sensors/water.h"
#include "sil/pair_maker.h"

namespace fathom {

/// What the recording's camera would have recorded in some water: like is compared with like, so with the
/// sensor's noise, and by way of JPEG where the recording's images are JPEG. For many threads at once.
class WaterCamera {
 public:
  /// `jpeg_quality` absent: the images are exact.
  WaterCamera(CameraSheet sheet, const CameraModel& model, std::optional<int> jpeg_quality,
              std::uint64_t seed);

  const CameraSheet& sheet() const { return sheet_; }
  /// CV_8UC3. The noise depends on the seed and the number only, and is the same in every water.
  cv::Mat image(const View& clean, const Environment& environment, std::size_t number,
                double log_gain = 0) const;

 private:
  CameraSheet sheet_;
  ImageModel model_;
  std::optional<int> jpeg_quality_;
  std::uint64_t seed_;
};

}  // namespace fathom
