#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"

/// Camera calibrations as other programs write them.
namespace fathom {

struct CameraFile {
  CameraModel camera;
  std::vector<std::string> remarks;  ///< what a user should know, one line each
};

struct CameraFileOptions {
  std::string camera;                               ///< which of several; empty: the only one, or cam0
  std::optional<std::array<int, 2>> image_size_px;  ///< of a file that does not say it, or says it wrongly
};

/// Reads what OpenCV's calibration writes (cv::FileStorage, YAML); ROS's camera_info, as its calibrator
/// writes it and as `topic echo` prints the message (the first of them); or Kalibr's camchain. Several
/// cameras may stand in one file under their names. Of each the lens is plumb bob, rational or a fisheye
/// (equidistant, Kannala-Brandt), pixel (0, 0) the centre of the first pixel. What none of these can express
/// (an omnidirectional mirror, skew, a thin prism) is an error, and so is a file that contradicts itself: one
/// that names a distortion model and has no coefficients under any key that is known, or the model `none` and
/// coefficients, two keys for the same with other numbers, rows and columns that are not those of the
/// numbers. What cannot be, or hardly (camera_check.h), what is not applied (binning, region of interest) and
/// later messages with another camera are remarks. Other keys of the file do not matter. Throws Error.
CameraFile readCameraFile(const std::filesystem::path& file, const CameraFileOptions& options = {});

/// A longer side of an image is taken for a mistake.
inline constexpr int kLargestImageSide_px = 20000;
/// Whether an image may have a side of so many pixels: a whole number, from 1 on.
bool isImageSide(double side_px);

/// Takes coefficients of the camera's lens, as OpenCV orders them; those that are missing stay.
void setLens(const std::vector<double>& coefficients, CameraModel& camera);

}  // namespace fathom
