#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fiducials/detection.h"
#include "panel/panel_map.h"

/// Corners of checkerboards as calibration data sets publish them, taken for markers: every second square of
/// a board stands for a tag36h11, so that each corner is one marker's.
namespace fathom {

/// How many inner corners a board has, and their spacing.
struct Checkerboard {
  int columns = 0, rows = 0;
  double square_m = 0;
};

struct BoardCorners {
  /// Board by board, in the frame that the table has its points in; x along its rows, z towards the camera.
  /// No mesh.
  std::vector<PanelMap> boards;
  std::map<std::string, std::vector<Detection>> by_image;
};

/// Two layouts, told apart by their columns:
/// - image, corner, u_px, v_px: the number of the corner row by row on `board`, which lies in the xy plane;
/// - x_mm, y_mm, z_mm, u_px, v_px: one image of points on one or more regular boards, each row by row; then
///   `board` is not asked for.
/// Throws Error: another layout, `board` missing, a corner that the board has not or that is there twice,
/// points on no regular grid, a board seen in a mirror, more squares than tag36h11
/// has ids.
BoardCorners readBoardCorners(const std::filesystem::path& table, const std::optional<Checkerboard>& board,
                              double sigma_px);

struct CalibratedCamera {
  CameraModel camera;
  double rms_px = 0;  ///< of the reprojection
};
/// Pinhole with plumb-bob distortion from all views of the boards (Zhang 2000, as OpenCV has it). Throws
/// std::invalid_argument: fewer than three views, or of several boards.
CalibratedCamera calibrateCamera(const BoardCorners& corners, int width_px, int height_px);

}  // namespace fathom
