#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/camera_model.h"

/// Tie points: what both cameras of a pair see, wherever it is. A table beside a rawlog.
namespace fathom {

struct TiePoint {
  int id = 0;                        ///< of what is seen, e.g. of a track
  std::array<Vector2d, 2> pixels{};  ///< left, right
  std::array<double, 2> sigma_px{};  ///< of each coordinate
};

/// By the left image's file name in the image folder.
using TiePoints = std::map<std::string, std::vector<TiePoint>>;

/// NAME_points.csv.
std::filesystem::path tiePointsBeside(const std::filesystem::path& rawlog);

/// A row a point: image (the left one's file name), id, and of each eye u_px, v_px, sigma_px: left_u_px … .
/// Throws Error where it cannot be written.
void writeTiePoints(const std::filesystem::path& file, const TiePoints& points);

/// Throws Error: another column, a value that is none, a sigma that is not greater than zero, an id twice in
/// an image.
TiePoints readTiePoints(const std::filesystem::path& file);

}  // namespace fathom
