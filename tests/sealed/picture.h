#pragma once

#include <opencv2/core.hpp>

#include "lamp_light.h"
#include "painted_panel.h"
#include "sight_lines.h"
#include "viewpoint.h"
#include "water_light.h"

namespace fathom::sealed {

/// What reaches the lens of each pixel, linear red, green, blue.
struct Picture {
  /// The scene's light after as many bends as the index says, not yet smeared by them; one entry where light
  /// is not bent.
  std::vector<cv::Mat3f> scene;
  cv::Mat3f veil;     ///< what the water itself shines with
  cv::Mat1f depth_m;  ///< along the optical axis, in the pixel's middle; a kilometre where there is but water
};

/// One image's view.
struct View {
  const Camera& camera;
  const SealedCase& sealed;
  const Viewpoint& viewpoint;
  const TruePanel& panel;
  const PaintedPanel& painted;
  const SightLines& sight;
  const WaterLight& water;
  const LampLight& lamps;
  double stamp_s;
  double exposure_s;  ///< around each row's time
};

/// How often light that reaches the lens has been bent at most: the last entry is for all that was more
/// often.
inline constexpr int kBends = 3;

/// Traces a ray through each pixel; through those at whose edge something changes, or sweeps by during the
/// exposure, many, each at its own time (distributed ray tracing: Cook et al. 1984).
Picture takePicture(const View& view);

}  // namespace fathom::sealed
