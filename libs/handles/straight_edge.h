#pragma once

#include <vector>

#include "handles/contour.h"

/// The paper's chain from a contour on: Canny, Hough, the most prominent straight edge.
namespace fathom {

/// A straight edge, front view.
struct StraightEdge {
  Vector2d from_px{0, 0}, to_px{0, 0};
};

/// A handle's angle as its straight edges have it.
struct EdgeReading {
  bool found = false;
  std::string why_not;      ///< where there is none
  double angle_rad = 0;     ///< in the panel's frame; one of those that symmetry leaves
  double symmetry_rad = 0;  ///< of this reading: where two ends could not be told apart, half of the handle's
  double sigma_rad = 0;     ///< of the line through the edge's pixels
  double prominence = 0;    ///< its share of what it and the next best direction have: 0.5 to 1
  StraightEdge edge;
  cv::Mat edges;  ///< CV_8UC1: what Canny has found inside
};

/// Edges (Canny 1986) of the colour that changes most, inside the contour; straight ones
/// among them (Hough, Duda & Hart 1972); the longest, and with it all edges along it, give the direction. A
/// lever points to where most of the contour is; of a wheel's four directions, the marked spoke's is the one
/// unlike the others.
EdgeReading readStraightEdge(const FrontView& view, const Contour& contour, const Handle& handle);

}  // namespace fathom
