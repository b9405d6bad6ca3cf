// What sensors would read along a planned path, through what is known to be before them.
#include "diagnosis/manoeuvre_readings.h"

#include <gtest/gtest.h>

#include "imaging/camera_geometry.h"
#include "support/shipped.h"

namespace fathom {
namespace {

/// A recording that has seen one marker of a row of them, to the side, 2 m before the camera.
BatchData rowOfMarkers() {
  BatchData recording;
  recording.vehicle = readVehicle(test::kRov);
  PanelMap panel;
  panel.T_odom_panel.rotation << 0, 0, -1, -1, 0, 0, 0, 1, 0;  // faces back along odom's x
  panel.T_odom_panel.position = {2, 0, 0};
  for (int id = 0; id < 40; ++id)
    panel.markers.push_back({"", id, 0.1, {Matrix3d::Identity(), {-2.0 + 0.1 * id, 0, 0}}});
  recording.panels = {panel};
  BatchMarker seen;
  seen.camera = recording.vehicle.camera->model;
  seen.T_robot_camera.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // looks ahead
  recording.markers = {seen};
  ImagePatch patch;
  patch.T_robot_camera = seen.T_robot_camera;
  patch.point_panel = {0.5, 0.3, 0};
  recording.patches = {patch};
  return recording;
}

BatchData seenAtRest(const EffectParameters<double>& effects) {
  return readingsAlong(rowOfMarkers(), {0, 0.2}, {Pose{}, Pose{}}, effects);
}

TEST(ManoeuvreReadings, AreSeenThroughThePort) {
  EffectParameters<double> port;
  port.add<FlatPortRefraction>({0.05, 0.01, 0, 0, 0.34, 0});  // of a camera calibrated in air: a third nearer
  const BatchData straight = seenAtRest({}), bent = seenAtRest(port);
  ASSERT_FALSE(bent.markers.empty());
  EXPECT_LT(bent.markers.size(), straight.markers.size()) << "what a port magnifies leaves the picture";
  for (const BatchMarker& seen : bent.markers) {
    const auto corners =
        predictCorners<double>({}, nominalPlacement<double>(bent.panels[0].T_odom_panel, seen.t_s),
                               seen.marker, seen.camera, seen.T_robot_camera, port, seen.t_s);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_LT((seen.detection.corners_px[k] - corners[k]).norm(), 1e-9) << seen.marker.id;
  }
  ASSERT_FALSE(bent.patches.empty() || straight.patches.empty());
  const Vector2d middle(bent.markers[0].camera.cx_px, bent.markers[0].camera.cy_px);
  EXPECT_NEAR((bent.patches[0].pixel - middle).norm() / (straight.patches[0].pixel - middle).norm(), 1.34,
              0.05);
}

}  // namespace
}  // namespace fathom
