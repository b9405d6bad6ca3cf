#pragma once

#include "handles/front_view.h"

namespace fathom {

/// What an image has of a handle, as a camera without distortion would see it that stands in the same place
/// and looks at the handle: turning a camera about its own centre moves nothing before anything else.
struct CloseUp {
  CameraModel camera;   ///< as many pixels a radian as the image's, one of a few sizes
  Pose T_panel_camera;  ///< of the close-up
  cv::Mat light;        ///< CV_32FC3, linear red, green, blue
  cv::Mat in_reach;     ///< CV_8UC1: 255 where the handle may be seen, whatever its angle
};

/// The handle must be in view (FrontView).
CloseUp closeUpOf(const PosedPanelImage& image, const Handle& handle);

}  // namespace fathom
