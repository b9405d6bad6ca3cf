#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "imaging/marker_blur.h"

namespace fathom {

/// How much softer edges are in an image than in its rendering, of a part of it such as a marker.
struct EdgeBlur {
  Vector3d variance_px2 = Vector3d::Zero();    ///< xx, xy, yy of a normal blur's covariance
  Matrix3d covariance_px4 = Matrix3d::Zero();  ///< of that
  Vector2d shift_px = Vector2d::Zero();        ///< of the image against its rendering
};

/// A part of an image, its rendering, and how that looks where all is mixed with what is far around (forward
/// scattering): CV_32FC1, of one size; linear light.
struct EdgeView {
  cv::Mat seen, rendered, around;
  cv::Mat mask;  ///< CV_8UC1: not 0 where it counts; what is within edgeReach_px() must be of the view too
  double noise = 0;  ///< standard deviation of a pixel of `seen`; what the fit leaves counts where it is more
};

struct EdgeBlurOptions {
  double smoothing_px =
      kEdgeSmoothing_px;  ///< standard deviation by which both are smoothed, so that pixels matter little
  int rounds = 4;
  double least_contrast = 0.1;  ///< standard deviation of the rendering's albedo over what counts
  int least_pixels = 150;
  double largest_shift_px = 2;
};

/// How far the smoothing reaches: so near to its border nothing of a view counts.
int edgeReach_px(const EdgeBlurOptions& options = {});

/// The normal blur and the shift that take `rendered` to `seen`, with light and veil that vary linearly over
/// the view and a share of what is around: Gauss-Newton on both smoothed images. Nothing where there are too
/// few pixels or too little contrast, or no solution.
std::optional<EdgeBlur> edgeBlur(const EdgeView& view, const EdgeBlurOptions& options = {});

}  // namespace fathom
