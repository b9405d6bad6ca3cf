// The shipped trial: its images tell what they should, and honestly. Every fifth image, for time's sake.
#include <gtest/gtest.h>

#include <iostream>

#include "core/linear_algebra.h"
#include "landmarks/landmark_source.h"
#include "panel/panel_maps.h"
#include "support/detections.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const fs::path kTrial = fs::path(FATHOM_SOURCE_DIR) / "rawlogs/trial";

struct View {
  Time time;
  ImageSample image;
  std::optional<Pose> T_camera_panel;  ///< truth, of the same instant
};

/// All images with their truth; the TRUTH of an instant comes with its image.
std::vector<View> viewsOf(const PanelMap& panel) {
  std::vector<View> views;
  std::map<Time, Pose> truth;
  RecordingSource source(kTrial / "trial.rawlog");
  while (const auto sample = source.next()) {
    if (const auto* image = std::get_if<ImageSample>(&sample->reading))
      views.push_back({sample->time, *image, {}});
    if (sample->label == labels::kTruth)
      truth[sample->time] = std::get<PoseSample>(sample->reading).T_odom_robot.mean;
  }
  for (View& view : views)
    if (truth.contains(view.time))
      view.T_camera_panel = (truth.at(view.time) * view.image.T_robot_camera).inverse() * panel.T_odom_panel;
  return views;
}

/// Whether two markers or more are whole in the image, at most 3 m away.
bool isInView(const View& view, const PanelMap& panel) {
  const CameraModel camera = view.image.intrinsics.model;
  int whole = 0;
  for (const Marker& marker : panel.markers) {
    const auto corners = marker.corners_panel();
    whole += std::all_of(corners.begin(), corners.end(), [&](const Vector3d& corner) {
      const Vector3d p = *view.T_camera_panel * corner;
      const Vector2d pixel = camera.project(p);
      constexpr double kBorder_px = 10;  // a marker needs its quiet zone
      return p.z() > 0.1 && pixel.x() > kBorder_px && pixel.y() > kBorder_px &&
             pixel.x() < camera.width_px - kBorder_px && pixel.y() < camera.height_px - kBorder_px;
    });
  }
  return whole >= 2 && view.T_camera_panel->position.norm() < 3.0;
}

TEST(Trial, PanelsAreSeenWhereTheyShouldBeAndAsWellAsTheySay) {
  const auto panels = readPanelMaps(kTrial / "trial_panel/panel.yaml");
  const auto views = viewsOf(panels[0]);
  EXPECT_GE(views.size(), 600U);
  std::vector<CameraImage> images;
  for (std::size_t i = 0; i < views.size(); i += 5)
    images.push_back({kTrial / "trial_Images" / views[i].image.file, views[i].image.intrinsics.model});
  const DetectionSettings settings = settingsFor(panels);
  const auto found = detectImages(images, settings, "");
  ASSERT_TRUE(found.unreadable.empty());

  int in_view = 0, seen_in_view = 0, used = 0;
  double nees = 0;
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < views.size(); i += 5) {
    const View& view = views[i];
    ASSERT_TRUE(view.T_camera_panel);
    const auto* detections = found.find(kTrial / "trial_Images" / view.image.file);
    const Sighting sighting =
        sightingOf({{*detections, view.image.intrinsics.model, {}}}, view.image.T_robot_camera, panels);
    in_view += isInView(view, panels[0]) ? 1 : 0;
    seen_in_view += isInView(view, panels[0]) && !sighting.panels.panels.empty() ? 1 : 0;
    for (const SeenPanel& seen : sighting.panels.panels) {
      const Vector6d error = test::poseError(seen.T_camera_panel.pose, *view.T_camera_panel);
      nees += normalizedSquare(seen.T_camera_panel.covariance, error);
      errors_m.push_back(error.head<3>().norm());
      ++used;
    }
  }
  std::sort(errors_m.begin(), errors_m.end());
  std::cout << in_view << " images with the panel in view, seen in " << seen_in_view << "; error median "
            << errors_m[errors_m.size() / 2] << " m, largest " << errors_m.back() << " m; mean NEES "
            << nees / used << "\n";
  EXPECT_GT(in_view, 70);
  EXPECT_GE(seen_in_view, 0.85 * in_view);
  EXPECT_LT(errors_m[errors_m.size() / 2], 0.002);
  EXPECT_LT(errors_m.back(), 0.3);
  // 6 expected; JPEG's errors are not white, so that more is granted.
  EXPECT_LT(nees / used, 15);
}

}  // namespace
}  // namespace fathom
