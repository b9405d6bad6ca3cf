#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/image_texture.h"
#include "sensors/vehicle.h"

/// What interpolated colours and compression leave in the noise of an image's plain surfaces.
namespace fathom {

/// Of an image (CV_8UC3, blue green red, not cropped: blocks begin at its first pixel), on known surfaces of
/// one albedo (`mask`, CV_8UC1, not 0 there), of which `labels` (CV_32SC1) says which; below 0: none that
/// counts. Stamp and image are the caller's. Nothing where too few pixels are well exposed.
///
/// Steps count in blocks of which all counts. Squared differences are summed up by squares of 32
/// pixels of each label. What is ten times as far off as noise would be, at some speck or edge, does not
/// count. Sigmas are from how differently the squares contribute (the sandwich estimate of a ratio), and at
/// least what independent normal differences would have. Noise is the camera's sheet's at the squares'
/// brightness, slopes are planes' through them.
std::optional<ImageTexture> measureTexture(const cv::Mat& image, const cv::Mat& mask, const cv::Mat& labels,
                                           const CameraSheet& sheet);

/// Of the images of one recording: turns the chessboards' sign where all together say, by more than chance
/// ever would, that green is measured on the pixels whose coordinates add up to an even number. Where there
/// is no chessboard it is left alone, so that means stay zero.
void setChessboard(std::vector<ImageTexture>& textures);

}  // namespace fathom
