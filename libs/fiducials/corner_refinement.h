#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "fiducials/detection.h"

namespace fathom {

struct RefinedCorners {
  std::array<Vector2d, 4> corners_px;
  Matrix8d covariance_px2;
  double contrast;       ///< mean of the four edges, digital numbers
  double blur_sigma_px;  ///< mean of the four edges, the pixel's own width left out
};

/// Corners as the intersections of the border square's edges. An edge is fitted to all pixels near it: a step
/// blurred by a Gaussian, levels linear along the edge, least squares on the pixel values (no interpolation,
/// so that the pixels' noise is white and the covariance follows from the residuals).
///
/// `gray` is CV_8UC1, `rough_px` is good to a third of a cell, `cell_px` the width of a cell: pixels farther
/// from the edge than that show other cells. With a camera, edges are straight in its ideal image; without
/// one, in this image. Nothing where an edge is not found.
///
/// Where the blur is known beforehand, about, from another marker of the image, `rough_px` must be good to a
/// pixel: the edges are then not looked for from afar, which halves the time.
std::optional<RefinedCorners> refineCorners(const cv::Mat& gray, const std::array<Vector2d, 4>& rough_px,
                                            double cell_px, const CameraModel* camera = nullptr,
                                            const std::optional<double>& blur_sigma_px = std::nullopt);

}  // namespace fathom
