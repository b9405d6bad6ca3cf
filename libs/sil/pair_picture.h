#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "similarity/measure.h"

/// Pairs for people to look at: CV_8UC3, blue, green, red.
namespace fathom {

/// By what colour a difference of linear light (Rec. 709's luminance, shares of the camera's full scale) is
/// shown: blue where the simulated image is brighter, white where both are the same, orange where the
/// recorded one is; full colour from `scale` on. Both colours are of Okabe and Ito's, which colour-blind
/// readers tell apart.
struct ResidualScale {
  double full_scale = 0.1;
};

/// Recorded minus simulated in linear light, CV_32FC1. The pair's camera must be known.
cv::Mat luminanceResidual(const ImagePair& pair);

/// Gray where `region` (CV_8UC1) is 0: not compared.
cv::Mat residualPicture(const ImagePair& pair, const cv::Mat& region, const ResidualScale& scale);

/// A linear camera's image as the eye would have it (power 1 / 2.2); the response is undone first.
cv::Mat brightenedForEye(const cv::Mat& image_bgr, const CameraSheet& camera);

/// Recorded, simulated and residual, each `width_px` wide (0: as it is).
std::vector<cv::Mat> pairTiles(const ImagePair& pair, const cv::Mat& region, const ResidualScale& scale,
                               int width_px = 0);
/// The same side by side, with a line of text below.
cv::Mat pairPicture(const ImagePair& pair, const cv::Mat& region, const ResidualScale& scale,
                    const std::string& caption, int width_px = 0);

/// What colours mean, one line of ASCII.
std::string legendOf(const ResidualScale& scale);

}  // namespace fathom
