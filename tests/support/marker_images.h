#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/random.h"
#include "panel/panel_map.h"

/// Images of flat markers, drawn sample by sample with no renderer: truth for the detectors.
namespace fathom::test {

struct Look {
  double black = 30, white = 200, background = 120;  ///< digital numbers
  double blur_sigma_px = 0.6;                        ///< of the lens; the pixel's square adds to it
  double noise_sigma = 1.0;                          ///< digital numbers, white
  int supersampling = 6;                             ///< squared: samples a pixel
};

/// All markers of the map must be in front of the camera. CV_8UC1.
cv::Mat drawMarkers(const std::vector<Marker>& markers, const CameraModel& camera, const Pose& T_camera_panel,
                    const Look& look, Random& random);

Marker markerAt(const std::string& family, int id, double size_m, double x, double y, double rotation = 0);

/// A camera that looks at the panel's centre from `distance_m`, the panel turned by `tilt` about an axis of
/// its plane at `axis` from x, and by `roll` about the line of sight.
Pose lookingAtPanel(double distance_m, double tilt, double axis = 0, double roll = 0);

/// Where the marker's corners truly are.
std::array<Vector2d, 4> trueCorners(const Marker& marker, const CameraModel& camera,
                                    const Pose& T_camera_panel);

}  // namespace fathom::test
