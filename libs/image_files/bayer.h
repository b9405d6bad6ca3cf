#pragma once

#include <opencv2/core.hpp>

#include "core/camera_model.h"

/// Images of which each pixel measures one colour.
namespace fathom {

/// What a sensor of this pattern measures of an image (BGR, 8 or 16 bits): one channel. Of the pattern
/// `none`, or where there is one channel already, the image.
cv::Mat mosaic(const cv::Mat& image_bgr, BayerPattern pattern);

/// BGR, each colour where it was not measured the mean of its next neighbours (bilinear). Of the pattern
/// `none` the image. Throws std::invalid_argument: not of one channel.
cv::Mat demosaiced(const cv::Mat& raw, BayerPattern pattern);

}  // namespace fathom
