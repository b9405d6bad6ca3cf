#pragma once

#include <array>
#include <opencv2/imgproc.hpp>
#include <opencv2/quality/qualityssim.hpp>

#include "similarity/measure.h"

namespace fathom {

/// Structural similarity of luminance: means, variances and covariance in Gaussian windows of sigma 1.5 px.
/// Source: Wang, Bovik, Sheikh & Simoncelli, "Image Quality Assessment: From Error Visibility to Structural
/// Similarity", IEEE Transactions on Image Processing 13(4), 2004; OpenCV's.
struct SsimMeasure {
  static constexpr std::string_view id = "ssim";
  static constexpr std::string_view about = "structural similarity of luminance (Wang et al. 2004), -1 to 1";
  static constexpr std::array<Quantity, 1> quantities{{{"ssim", "1", Better::higher}}};

  static MeasureOutcome measure(const PairView& pair) {
    cv::Mat recorded, simulated;
    cv::cvtColor(pair->recorded, recorded, cv::COLOR_BGR2GRAY);
    cv::cvtColor(pair->simulated, simulated, cv::COLOR_BGR2GRAY);
    return {{cv::quality::QualitySSIM::compute(recorded, simulated, cv::noArray())[0]}, ""};
  }
};

}  // namespace fathom
