#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera_fit.h"
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
  std::vector<BoardView> views;  ///< every corner of each image, to calibrate a camera from
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

/// The views under names that no other table's have, PREFIX/IMAGE.
std::vector<BoardView> boardViews(const BoardCorners& corners, const std::string& prefix, bool in_water);

}  // namespace fathom
