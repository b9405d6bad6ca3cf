#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// What a fiducial looks like, whichever library detects it.
namespace fathom {

/// A square of cells, row by row from the top left, seen upright: as the library's own drawing function shows
/// it (cv::aruco::drawMarker, apriltag_to_image). The border square, whose corners the detectors find, spans
/// `border_cells` cells and is centred. The pattern can reach beyond it: AprilTag's classic families have a
/// white ring around their black border; the others (tagCircle…, tagCustom…, tagStandard…) have a white
/// border with a black ring and data around it.
///
/// The tags that both libraries have (tag36h11 is DICT_APRILTAG_36h11, likewise 16h5, 25h9, 36h10) have the
/// same cells in the border square, but OpenCV's are drawn half a turn from AprilTag's.
struct MarkerPattern {
  int cells = 0;
  int border_cells = 0;
  std::vector<std::uint8_t> white;  ///< cells * cells entries: 1 white, 0 black

  bool whiteAt(int row, int column) const { return white[index(row, column)] != 0; }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cells) + static_cast<std::size_t>(column);
  }
};

/// How markers are printed, where not black on white with a border one cell wide.
struct MarkerLook {
  int border_width = 1;  ///< of the border, cells: 1 or 2; 2 (Kalibr's grids) for plain families only
  bool white_on_black = false;
  /// Its corners are saddle points, where squares of a checkerboard meet: white that grows over black, or a
  /// camera's response, moves none of them.
  bool saddle_corners = false;

  friend bool operator==(const MarkerLook&, const MarkerLook&) = default;
};

/// All families: OpenCV's dictionaries (DICT_ARUCO_ORIGINAL, DICT_4X4_50 …) and AprilTag's (tag36h11,
/// tagStandard41h12 …), sorted.
const std::vector<std::string>& markerFamilies();
bool isMarkerFamily(const std::string& family);
/// Number of ids; ids count from 0. Throws std::invalid_argument for an unknown family.
int markerCount(const std::string& family);
/// Whether a family is a plain one: data cells inside a black border one cell wide, nothing but white
/// outside. Only those are known to OpenCV.
bool hasPlainBorder(const std::string& family);
/// White on black, with one black cell around it at least. Throws std::invalid_argument: unknown family, no
/// such id in it, or a border of two cells that is not plain.
MarkerPattern markerPattern(const std::string& family, int id, const MarkerLook& look = {});

}  // namespace fathom
