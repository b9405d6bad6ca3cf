#pragma once

#include "core/random.h"
#include "fiducials/panel_pose.h"
#include "support/marker_images.h"

/// Detections without images: corners projected, noise of a known covariance added.
namespace fathom::test {

/// `columns` by `rows` markers of one family, ids from `first_id`, 0.45 m by 0.36 m apart, with turns of
/// their own.
PanelMap gridPanel(int columns, int rows, int first_id = 0);

/// An edge-fit-like covariance: neighbours along a side anticorrelated, scaled to sigma.
Matrix8d cornerCovariance(double sigma_px);

/// What a camera sees of a panel: all of its markers, wherever they are in the image.
std::vector<Detection> detectionsOf(const PanelMap& map, const CameraModel& camera,
                                    const Pose& T_camera_panel, double sigma_px, Random& random);

/// (dp, dr) of an estimate of a pose, see UncertainPose.
Vector6d poseError(const Pose& estimate, const Pose& truth);

}  // namespace fathom::test
