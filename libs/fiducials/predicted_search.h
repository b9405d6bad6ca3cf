#pragma once

#include <vector>

#include "fiducials/detector.h"
#include "panel/panel_map.h"

namespace fathom {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Where the panel is thought to be.
struct PanelPrediction {
  Pose T_camera_panel;
  /// Of position (camera axes, m) and rotation vector (panel axes, rad): p + dp, R Exp(dr). As
  /// PanelPoseEstimate has it.
  Matrix6d covariance = Matrix6d::Zero();
  double margin_px = 8;  ///< on top of three sigma
};

/// Where a marker's border square and the quiet zone around it must be, margin included.
struct PredictedMarker {
  const Marker* marker = nullptr;
  cv::Rect area;
  double side_px = 0;  ///< shortest of its sides
};

/// Markers that should show: in front of the camera, facing it, at least partly in the image. In the map's
/// order; the pointers are into the map.
std::vector<PredictedMarker> predictMarkers(const PanelMap& map, const CameraModel& camera,
                                            const PanelPrediction& prediction);

/// The areas, those joined that are no larger together than apart.
std::vector<SearchRegion> searchRegions(const std::vector<PredictedMarker>& markers);

/// Searches only where markers must be, and keeps only what the map has there: first at the scale that the
/// predicted size allows, then, for markers missed so, as the whole image would be. Sorted as Detector does.
std::vector<Detection> detectPredicted(Detector& detector, const cv::Mat& image, const PanelMap& map,
                                       const CameraModel& camera, const PanelPrediction& prediction);

}  // namespace fathom
