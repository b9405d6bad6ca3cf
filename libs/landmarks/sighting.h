#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fiducials/panel_pose.h"
#include "panel/panel_map.h"
#include "recording/samples.h"

/// From the markers in an image, or in both images of a pair, to where panels and robot are.
namespace fathom {

/// A panel whose markers were seen, but whose pose is not used.
struct UnusedPanel {
  int panel = 0;  ///< index into the maps
  std::string why;
};

struct Sighting {
  /// T_odom_robot by the paper's baseline: the mean over all single markers of all panels (meanOfMarkers),
  /// with the panels where their maps have them. Its covariance means nothing: the identity.
  std::optional<PoseSample> robot;
  PanelSample panels;     ///< by the joint solution of each panel's markers
  MarkersSample markers;  ///< the joint solutions' inliers, where the solutions put their centres
  std::vector<UnusedPanel> unused;
};

inline constexpr const char* kAmbiguous = "ambiguous";  ///< UnusedPanel::why

/// `cameras` see at one instant; T_robot_camera is the first one's mounting. A panel is used where the
/// corners that all cameras saw of it determine one pose: one that could as well be its mirror image is not,
/// be it a single marker from afar or a panel seen from in front.
Sighting sightingOf(const std::vector<CameraDetections>& cameras, const Pose& T_robot_camera,
                    const std::vector<PanelMap>& panels, const PanelPoseOptions& options = {});

/// The camera's frame with x along the optical axis, y left, z up: T_camera_forward.
Pose forwardFrame();

}  // namespace fathom
