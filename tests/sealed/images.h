#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "exposure.h"
#include "painted_panel.h"
#include "viewpoint.h"

namespace fathom::sealed {

/// The camera's images, each by itself.
class ImageMaker {
 public:
  ImageMaker(const Vehicle& vehicle, const SealedCase& sealed, const TruePanel& panel,
             const Viewpoint& viewpoint);

  /// Blue, green, red.
  cv::Mat3b take(std::size_t index, double stamp_s) const;

 private:
  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  const TruePanel& panel_;
  const Viewpoint& viewpoint_;
  Paint paint_;
  Exposure exposure_;
};

/// As PNG, on all cores. Throws Error.
void writeImages(const std::filesystem::path& folder, const ImageMaker& maker,
                 const std::vector<double>& stamps_s);

}  // namespace fathom::sealed
