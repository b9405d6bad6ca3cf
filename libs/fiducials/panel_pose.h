#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/uncertain_pose.h"
#include "fiducials/detection.h"
#include "imaging/camera_geometry.h"
#include "panel/panel_map.h"

namespace fathom {

/// What one of several cameras on one body saw at one instant.
struct CameraDetections {
  std::vector<Detection> detections;
  CameraModel camera;
  Pose T_first_camera;  ///< this camera on the first one; taken as exact
  /// Where the camera sees things, if otherwise than `camera` says: a port that bends the light, rows that
  /// are read one after the other. `camera` is then near enough to start from.
  std::optional<CameraProjector<double>> projector{};

  CameraProjector<double> trueProjector() const {
    return projector.value_or(CameraProjector<double>::nominal(camera));
  }
};

/// Corners as `camera` would have seen them, had it no projector of its own: moved by what the two differ by
/// where the panel's pose has them. Markers that the map has not are left out.
std::vector<Detection> straightened(const CameraDetections& seen, const PanelMap& map,
                                    const Pose& T_first_panel);

/// What one marker has to say to the panel's pose.
struct MarkerFit {
  std::size_t camera = 0;     ///< index into the cameras given
  std::size_t detection = 0;  ///< index into its detections
  bool inlier = false;
  double rms_px = 0;      ///< reprojection, over the eight coordinates
  double chi_square = 0;  ///< whitened by the corners' covariance; 8 is to be expected
};

struct PanelPoseOptions {
  /// Probability that a marker in its place passes as an inlier.
  double inlier_probability = 0.999;
  /// A second minimum counts as possible where its chi-square is higher by less than this.
  double ambiguity_chi_square = 9.0;
  std::optional<Pose> T_camera_panel_guess;  ///< one more start, where there is one
};

struct PanelPoseEstimate {
  bool solved = false;
  std::string why_not = "not run";  ///< where it is not solved

  UncertainPose T_camera_panel;  ///< scale included
  double rms_px = 0;             ///< reprojection, inliers
  int inlier_count = 0;
  std::vector<MarkerFit> markers;  ///< those that the map has, in the order of cameras and detections
  /// By how much sigma had to grow because residuals are larger than the corners' covariance explains; 1
  /// where they are not.
  double sigma_scale = 1;
  /// A second, distinct pose that explains the inliers about as well: its mirror image, mostly.
  struct Alternative {
    Pose T_camera_panel;
    double chi_square_increase = 0;
  };
  std::optional<Alternative> alternative;

  bool isAmbiguous() const { return alternative.has_value(); }
};

/// The panel's pose from all corners of all markers at once. Starts from both poses of every single marker
/// and of their common plane, weighs markers robustly (Geman-McClure on each marker's eight whitened
/// residuals, its scale from their median), then solves least squares over the inliers. Up to half of the
/// markers may be misread or out of place; of two that disagree, neither is believed more, and the covariance
/// shows it.
PanelPoseEstimate solvePanelPose(const std::vector<Detection>& detections, const PanelMap& map,
                                 const CameraModel& camera, const PanelPoseOptions& options = {});

/// The same from several cameras at once, of a stereo pair for example: T_camera_panel is the first one's.
/// A marker that two of them see counts twice. There must be a camera.
PanelPoseEstimate solvePanelPose(const std::vector<CameraDetections>& cameras, const PanelMap& map,
                                 const PanelPoseOptions& options = {});

/// The pose whose planar points look nearly the same from afar: the normal mirrored at the line of sight
/// through a point of the panel, which stays in place.
Pose mirrorImage(const Pose& T_camera_panel, const Vector3d& centre_panel);

/// The robot's pose from the panel's. T_odom_panel and T_robot_camera are taken as exact.
UncertainPose robotPose(const UncertainPose& T_camera_panel, const Pose& T_odom_panel,
                        const Pose& T_robot_camera);

}  // namespace fathom
