#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "handles/swept_box.h"
#include "imaging/camera_geometry.h"

/// The region of interest of a handle, turned to the front.
namespace fathom {

/// An image, and where the panel was before the camera.
struct PosedPanelImage {
  cv::Mat light;  ///< CV_32FC3, linear red, green, blue (radianceOf())
  CameraModel camera;
  CameraProjector<double> projector;  ///< where it truly sees things
  Pose T_camera_panel;
  bool is_jpeg = false;  ///< it came by way of JPEG, whose blocks of colour are 16 pixels wide
};

/// What an image has of a handle, as if seen from in front: on the plane in which the handle's straight edges
/// turn, so that angles there are angles in the panel's frame. x is to the right, y up: the first row is the
/// uppermost.
struct FrontView {
  std::string why_not;  ///< empty where there is a view: too small, beside the image, from behind
  cv::Rect region_px;   ///< of the image: what the swept box covers there

  cv::Mat light;             ///< CV_32FC3, as the image's
  cv::Mat in_reach;          ///< CV_8UC1: 255 where the handle may be seen, whatever its angle
  double m_per_px = 0;       ///< of this view
  double image_px = 0;       ///< a pixel of this view in the image's
  double silhouette_px = 0;  ///< as many pixels does the handle cover, seen from in front
  Vector2d axis_px{0, 0};    ///< where the handle turns

  /// Of the view, from metres beside the axis.
  Vector2d pixelOf(const Vector2d& foot_m) const {
    return {axis_px.x() + foot_m.x() / m_per_px, axis_px.y() - foot_m.y() / m_per_px};
  }
};

/// Nothing is said of whether something is in front of the handle.
FrontView frontViewOf(const PosedPanelImage& image, const Handle& handle);

}  // namespace fathom
