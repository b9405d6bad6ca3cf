#pragma once

#include "handles/handle_reader.h"

namespace fathom {

/// What speaks for a reading, for people to look at, side by side as in the paper's figure: the image with
/// the handle's region, the region turned to the front, the contour in it with its superellipse, the edges
/// with the most prominent straight one; then what matching compared: the close-up and the rendering.
/// CV_8UC3.
cv::Mat evidencePicture(const cv::Mat& image_bgr, const HandleReading& reading, const std::string& title);

}  // namespace fathom
