#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/camera_model.h"
#include "fiducials/detection.h"
#include "panel/panel_map.h"

namespace fathom {

/// A pose that explains a marker's corners, and how well.
struct MarkerPose {
  Pose T_camera_marker;
  double rms_px = 0;  ///< reprojection, over the eight coordinates
};

/// Both poses that the corners of one square allow (Collins and Bartoli, IPPE, 2014), the better first. The
/// second is its mirror image, nearly; where perspective is weak, noise decides which comes first. Empty
/// where the corners make no square.
std::vector<MarkerPose> poseOfMarker(const Detection& detection, double size_m, const CameraModel& camera);

/// Both poses of a set of coplanar points: `points` (x, y in their plane) seen at `pixels`. As above.
std::vector<Pose> poseOfPlane(const std::vector<Vector2d>& points_m, const std::vector<Vector2d>& pixels,
                              const CameraModel& camera);

/// The marker of the map that a detection shows; null where the map has none such.
const Marker* markerOf(const Detection& detection, const PanelMap& map);

/// The baseline (Mueller et al.): each marker's better pose gives one of the panel; the mean of their
/// positions and the incremental Slerp mean of their rotations with weights 1/n, in the order of the
/// detections. Nothing where no marker of the map is seen.
std::optional<Pose> meanOfMarkers(const std::vector<Detection>& detections, const PanelMap& map,
                                  const CameraModel& camera);

/// R1 for 0, R2 for 1, and between them the shorter way (Shoemake 1985).
Matrix3d slerp(const Matrix3d& R1, const Matrix3d& R2, double share);

}  // namespace fathom
