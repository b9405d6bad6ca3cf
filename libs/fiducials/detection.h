#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>

#include "core/camera_model.h"

namespace fathom {

using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

/// A marker seen in an image. Pixel (0, 0) is the centre of the top left pixel.
struct Detection {
  std::string family;  ///< see panel/marker_family.h
  int id = 0;
  /// Top-left, top-right, bottom-right, bottom-left of the border square, seen upright.
  std::array<Vector2d, 4> corners_px{};
  /// Of the corners (x0, y0, x1, y1 …), px². Neighbours share an edge, so they are correlated.
  Matrix8d covariance_px2 = Matrix8d::Identity();
  /// Whether the corners come from the fit of the edges; otherwise they are the backend's own and the
  /// covariance is a cautious guess.
  bool refined = false;

  // Quality; NaN or -1 where it is not known.
  /// AprilTag backend, Detector::confirm()
  int corrected_bits = -1;
  /// The same; digital numbers
  double decision_margin = std::numeric_limits<double>::quiet_NaN();
  double contrast = std::numeric_limits<double>::quiet_NaN();       ///< across the edges, digital numbers
  double blur_sigma_px = std::numeric_limits<double>::quiet_NaN();  ///< of the edges

  Vector2d centre_px() const {
    return 0.25 * (corners_px[0] + corners_px[1] + corners_px[2] + corners_px[3]);
  }
  /// Root mean square sigma of a corner coordinate, px.
  double sigma_px() const;
};

/// The lengths of the four sides, px; side k begins at corner k.
std::array<double, 4> sides_px(const std::array<Vector2d, 4>& corners_px);

}  // namespace fathom
