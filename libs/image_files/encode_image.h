#pragma once

#include <opencv2/core.hpp>
#include <string>

/// What images are turned into.
namespace fathom {

/// For people to look at, and cv::imwrite(): CV_8UC3, blue, green, red, with the sRGB curve (IEC 61966-2-1).
/// From CV_32FC3, linear red, green, blue; 1 is white, and what is brighter is too. Throws
/// std::invalid_argument: not CV_32FC3.
cv::Mat toDisplay(const cv::Mat& radiance);

/// An image as the bytes of a file. Throw std::invalid_argument where OpenCV cannot encode it so.
std::string pngBytes(const cv::Mat& image);
std::string jpegBytes(const cv::Mat& image, int quality);

}  // namespace fathom
