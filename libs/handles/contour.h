#pragma once

#include <opencv2/core.hpp>

#include "handles/front_view.h"
#include "handles/superellipse.h"

/// What of a front view is the handle: an active contour that region terms drive, led by a superellipse.
namespace fathom {

struct ContourOptions {
  double region = 0.35;    ///< weight of the region terms, against a contour's own smoothness
  double shape = 0.25;     ///< weight of the superellipse
  double smooth_px = 1.5;  ///< sigma of the smoothing, pixels of the image
  int rounds = 40;         ///< at most
};

struct Contour {
  bool found = false;   ///< what is inside can be told from what is outside
  cv::Mat mask;         ///< CV_8UC1, the front view's: 255 inside
  cv::Mat evidence;     ///< CV_32FC1: ln p(colour | inside) - ln p(colour | outside)
  Superellipse shape;   ///< of the mask
  double contrast = 0;  ///< mean evidence for what was decided, nats a pixel
};

/// Outside is what is beyond the handle's reach: three normal distributions of colour. Inside is at first
/// what these do not explain: two. The contour moves by threshold dynamics (Esedoglu & Tsai 2006), which
/// smooths it as its length would: the mask is blurred, what the colours say and what the superellipse of the
/// last mask says are added, and the sum is cut at one half; so again until nothing changes (Chan & Vese 2001
/// with the shape prior of Koehntopp et al. 2015). What does not hang together with the largest piece is left
/// out.
Contour contourOf(const FrontView& view, const ContourOptions& options = {});

}  // namespace fathom
