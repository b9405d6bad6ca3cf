#pragma once

#include <opencv2/core.hpp>

#include "core/camera_model.h"

/// What a View's images are turned into.
namespace fathom {

/// Depth along the optical axis, z, from slant range; CV_32FC1, infinite where the range is. Solves every
/// pixel's line of sight anew (0.2 s at 640 x 480). Throws std::invalid_argument: not CV_32FC1 of the
/// camera's size.
cv::Mat depthAlongAxis(const cv::Mat& range_m, const CameraModel& camera);

/// For people to look at, and cv::imwrite(): CV_8UC3, blue, green, red, with the sRGB curve (IEC 61966-2-1).
/// From CV_32FC3, linear red, green, blue; 1 is white, and what is brighter is too. Throws
/// std::invalid_argument: not CV_32FC3.
cv::Mat toDisplay(const cv::Mat& radiance);

}  // namespace fathom
