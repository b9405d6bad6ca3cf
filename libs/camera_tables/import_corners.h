#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>

#include "camera_tables/board_corners.h"
#include "core/camera_model.h"
#include "recording/imported.h"
#include "report/run_info.h"

namespace fathom {

/// Measured corners of checkerboards, and the camera that saw them.
struct CornerTable {
  std::filesystem::path table;        ///< see readBoardCorners()
  std::optional<Checkerboard> board;  ///< likewise
  CameraModel camera;
  double sigma_px = 0.1;  ///< of a corner's coordinate
};

struct CornerImport {
  std::size_t images = 0, boards = 0, squares = 0;
  std::filesystem::path map;  ///< of the boards
};

/// Writes a recording with the squares drawn, a map of the boards, a vehicle file, the table of corners that
/// stands for what would be found in the images, and NAME_import.json. Of a camera above water, a board whose
/// corners the table numbers is taken to lie level, face up; a table with points has z up. Throws Error,
/// Interrupted.
CornerImport importCorners(const CornerTable& source, const ImportTarget& target, const RunInfo& run);

/// Intrinsics as such data sets publish them: fx_px, fy_px, cx_px, cy_px, distortion; `above_water: true` of
/// a camera that looks down into water from the air. Where no size stands there or in `size` (width, height),
/// the principal point is taken for the image's middle. Throws Error.
CameraModel readIntrinsics(const std::filesystem::path& file, const std::optional<std::array<int, 2>>& size);

}  // namespace fathom
