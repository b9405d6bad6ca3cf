#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "core/camera_model.h"

/// The shape prior of the segmentation (Koehntopp et al. 2015).
namespace fathom {

/// |x / a|^n + |y / b|^n <= 1 in axes of its own: an ellipse at n = 2, towards a rectangle with larger n.
struct Superellipse {
  Vector2d centre_px{0, 0};
  Vector2d half_axes_px{1, 1};  ///< a, b
  double turn_rad = 0;          ///< of its x axis, from the image's x towards its y
  double exponent = 2;          ///< n, from 1 to 10

  /// How many times the outline's distance from the centre a point is: 1 on the outline.
  double reach(const Vector2d& pixel) const;
  /// CV_32FC1, `size` large: 1 inside, 0 outside, half on the outline, from one to the other in about a
  /// pixel.
  cv::Mat drawn(const cv::Size& size) const;
};

/// The one nearest to a mask (CV_8UC1, not 0: inside), by least squares of what it draws (Ceres); begins with
/// `start`, or the ellipse of the mask's moments. There must be a pixel inside.
Superellipse superellipseOf(const cv::Mat& mask, const std::optional<Superellipse>& start = {});

}  // namespace fathom
