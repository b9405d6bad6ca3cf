#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "fiducials/detection.h"
#include "panel/marker_family.h"

/// Reading a marker whose place and code are known beforehand, more or less: no search, no library.
namespace fathom {

/// A marker that should show.
struct ExpectedMarker {
  std::string family;  ///< see panel/marker_family.h
  int id = 0;
  std::array<Vector2d, 4> corners_px{};  ///< as Detection has them
  double sigma_px = 0;                   ///< the largest of a corner's place, in any direction
  std::optional<double> blur_sigma_px;   ///< of the edges, from another marker of the image
};

/// Where in the image the marker's cells match best, within three sigma of where they are expected: the
/// corners, shifted alike, to about half a pixel, or a sixth of a cell where that is more (normalized
/// correlation, Lewis 1995). Nothing where nothing there resembles the marker. `gray` is CV_8UC1, the pattern
/// one of a black border.
std::optional<std::array<Vector2d, 4>> locateMarker(const cv::Mat& gray, const MarkerPattern& pattern,
                                                    const ExpectedMarker& expected);

/// How a marker's cells look.
struct CellReading {
  bool border_is_whole = false;  ///< all border cells are black, all cells around them white
  int wrong_bits = 0;
  /// Mean distance of the cells' brightness from the threshold between black and white, digital numbers; the
  /// less of that of black and that of white cells. As AprilTag's decision margin.
  double margin = 0;
};

/// Samples the cells between exact corners. Black and white are planes fitted to the border and to the cells
/// around it. `gray` is CV_8UC1; of the pattern, that has a black border, the border square counts.
CellReading readCells(const cv::Mat& gray, const MarkerPattern& pattern,
                      const std::array<Vector2d, 4>& corners_px);

}  // namespace fathom
