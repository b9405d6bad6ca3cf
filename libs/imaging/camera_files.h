#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/camera_model.h"

/// Camera calibrations as other programs write them.
namespace fathom {

/// Reads what OpenCV's calibration writes (cv::FileStorage, YAML), a ROS camera_info file, or one camera of
/// a Kalibr camchain. `camera`: which one of a camchain; the others have no names. All three mean the same
/// model: a pinhole with plumb-bob distortion, pixel (0, 0) the centre of the first pixel. What that model
/// cannot express (fisheye, an omnidirectional mirror, rational coefficients that are not zero) is an error.
/// Other keys of the file do not matter. Throws Error.
CameraModel readCameraFile(const std::filesystem::path& file, const std::string& camera = "cam0");

/// A longer side of an image is taken for a mistake.
inline constexpr int kLargestImageSide_px = 20000;
/// Whether an image may have a side of so many pixels: a whole number, from 1 on.
bool isImageSide(double side_px);

/// Takes plumb-bob coefficients as OpenCV orders them: k1, k2, p1, p2 and perhaps k3, four at least.
void setPlumbBob(const std::vector<double>& coefficients, CameraModel& camera);

}  // namespace fathom
