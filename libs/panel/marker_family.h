#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// What a fiducial looks like, whichever library detects it.
namespace fathom {

/// A square of cells, row by row from the top left, seen upright. The black border square spans
/// `border_cells` cells and is centred; the pattern can reach beyond it (tagStandard41h12 does).
struct MarkerPattern {
  int cells = 0;
  int border_cells = 0;
  std::vector<std::uint8_t> white;  ///< cells * cells entries: 1 white, 0 black

  bool whiteAt(int row, int column) const {
    return white[static_cast<std::size_t>(row * cells + column)] != 0;
  }
};

/// All families: OpenCV's dictionaries (DICT_ARUCO_ORIGINAL, DICT_4X4_50 …) and AprilTag's (tag36h11 …),
/// sorted.
const std::vector<std::string>& markerFamilies();
bool isMarkerFamily(const std::string& family);
/// Number of ids; ids count from 0. Throws std::invalid_argument for an unknown family.
int markerCount(const std::string& family);
/// Throws std::invalid_argument: unknown family, or no such id in it.
MarkerPattern markerPattern(const std::string& family, int id);

}  // namespace fathom
