#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "core/camera_model.h"
#include "core/geometry.h"

/// A camera that stands before a window of a tank, as calibration data sets publish it: intrinsics with any
/// of OpenCV's distortions, and the window's corners, seen through air.
namespace fathom {

/// Pixels as a pinhole without distortion would have them.
struct StraightPixel {
  Vector2d pixel;
  double stretch = 1;  ///< of small distances there: what a sigma is multiplied by
};

struct WatchedWindow {
  CameraModel pinhole;             ///< focal lengths and principal point alone
  std::vector<double> distortion;  ///< OpenCV's order, 4, 5, 8, 12 or 14
  std::vector<Vector2d> corners_px;
  std::vector<Vector3d> corners_m;  ///< in a frame that all cameras of the data set have in common

  /// `camera`: a pinhole that shall see the same.
  StraightPixel straightened(const Vector2d& pixel, const CameraModel& camera) const;
};

/// YAML: fx_px, fy_px, cx_px, cy_px, distortion, reference_corners [{u_px, v_px, x_cm, y_cm, z_cm} …]. Throws
/// Error: not of this form, fewer than four corners, corners on a line.
WatchedWindow readWatchedWindow(const std::filesystem::path& file);

/// Where two cameras are, from the corners of their windows.
struct StereoRig {
  std::array<CameraModel, 2> cameras;  ///< left, right: pinholes with their windows
  Pose T_left_right;
  /// What the corners' scatter leaves uncertain, each axis: root mean square.
  double position_sigma_m = 0, angle_sigma_rad = 0;
  std::array<double, 2> corner_rms_px{};  ///< of the straightened corners, about where they should be
};

/// Throws std::invalid_argument where a camera cannot be placed. `corner_sigma_px`: of the corners, at least;
/// `seen_px`: what the pinholes' images must have room for, as seen by each camera.
StereoRig placeCameras(const std::array<WatchedWindow, 2>& windows, double corner_sigma_px,
                       const std::array<std::vector<Vector2d>, 2>& seen_px);

}  // namespace fathom
