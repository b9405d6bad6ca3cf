#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "core/camera_model.h"

namespace fathom {

/// Reads a PNG, JPEG or plain BMP image as CV_8UC3 (BGR) or, where it is gray, CV_8UC1; a PNG of 16 bits as
/// CV_16UC3 or CV_16UC1 (imaging/eight_bits.h has what makes eight of them). Pixels as stored (an EXIF
/// orientation is not applied: the camera's calibration is for the stored grid). Throws Error with the
/// byte where that helps: cannot be read, empty, none of these, cut off, damaged (PNG's checksums), not
/// decodable.
cv::Mat readImage(const std::filesystem::path& file);
/// The same of an image that this camera took; what it measured in a Bayer pattern, of one channel, is given
/// all its colours (demosaiced()). Throws Error, too, where it is not of the camera's size, or has colours
/// and the camera such a pattern.
cv::Mat readImage(const std::filesystem::path& file, const CameraModel& camera);

}  // namespace fathom
