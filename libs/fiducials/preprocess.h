#pragma once

#include <opencv2/core.hpp>
#include <string_view>

#include "imaging/water.h"
#include "sensors/vehicle.h"

namespace fathom {

/// What is done to a gray image before markers are searched in it. Corners are always fitted to the image as
/// it came.
enum class Preprocess {
  none,
  stretch,  ///< linear contrast stretch
  clahe,    ///< local histogram equalization with limited contrast (Zuiderveld 1994)
};
std::string_view nameOf(Preprocess preprocess);

/// Digital numbers of a gray image, 0 to 255.
struct GrayRange {
  double black = 0, white = 255;
};

/// What the gray of a black and of a white marker cell should be, seen range_m away along the optical axis:
/// the camera's forward model without effects. Radiances are the cells' without water: linear red, green,
/// blue.
GrayRange expectedRange(const Vector3d& black_radiance, const Vector3d& white_radiance, const Water& water,
                        const CameraSheet& sheet, double range_m);

/// CV_8UC1 of a gray or BGR image of 8 or 16 bits, these by the range that is used (imaging/eight_bits.h).
/// Throws std::invalid_argument for others.
cv::Mat toGray(const cv::Mat& image);

/// CV_8UC1 to CV_8UC1. Preprocess::stretch maps the range, widened by a tenth at each end, to 0 … 255; where
/// `range` is null it goes from the first to the 99th percentile of the image.
cv::Mat preprocessed(const cv::Mat& gray, Preprocess preprocess, const GrayRange* range);

}  // namespace fathom
