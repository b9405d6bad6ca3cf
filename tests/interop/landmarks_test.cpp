// From a simulated recording's images to landmarks, judged by its truth.
#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "landmarks/landmark_source.h"
#include "panel/panel_maps.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "support/detections.h"
#include "support/recordings.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using test::kSource;

/// Two and a half metres before both panels of maps/two_panels, moving a little.
constexpr const char* kBeforeTwoPanels =
    "kind: station\npose: {x: 3.0, y: 1.2, z: -4.25, yaw_deg: 3}\nduration_s: 20\nsway:\n"
    "  - {axis: y, amplitude_m: 0.1, period_s: 7}\n  - {axis: roll, amplitude_deg: 4, period_s: 5}\n"
    "  - {axis: pitch, amplitude_deg: 2, period_s: 6}\n  - {axis: yaw, amplitude_deg: 3, period_s: 8}\n";

/// Eight images (or pairs) in moderate water.
RecordingFiles simulate(const fs::path& folder, bool stereo, const ImageFormat& format) {
  writeTextFile(folder / "station.yaml", kBeforeTwoPanels);
  SimulationOptions options;
  options.vehicle = readVehicle(kSource / "config/rov.yaml");
  options.begin_s = 6;
  options.duration_s = 7;
  options.image_format = format;
  if (stereo) options.vehicle.camera->T_left_right = Pose{Matrix3d::Identity(), {0.12, 0, 0}};
  const RecordingTarget target{folder,
                               "r",
                               kSource / "config/rov.yaml",
                               kSource / "maps/two_panels/panels.yaml",
                               "a test",
                               readEnvironment(kSource / "config/water_moderate.yaml")};
  return simulateRecording(options, readTrajectory(folder / "station.yaml"), target);
}

struct Judged {
  int images = 0, panels = 0;
  double worst_m = 0, worst_rad = 0, mean_nees = 0, worst_robot_m = 0;
};

/// What a recording's images tell, against its truth of the same instant.
Judged judge(const RecordingFiles& files) {
  const auto panels = readPanelMaps(files.panel_map);
  std::map<Time, Pose> truth;
  RecordingSource first(files.rawlog);
  while (const auto sample = first.next())
    if (sample->label == labels::kTruth)
      truth[sample->time] = std::get<PoseSample>(sample->reading).T_odom_robot.mean;
  RecordingSource second(files.rawlog);
  const DetectionSettings settings = settingsFor(panels);
  const auto entries = imageEntries(second, {});
  const auto found = detectImages(imagesOf(entries), settings, keepBeside(files.rawlog));
  EXPECT_TRUE(found.unreadable.empty());

  LandmarkSource source(std::make_unique<RecordingSource>(files.rawlog),
                        std::make_shared<const Sightings>(solveSightings(entries, found, panels)));
  Judged judged;
  while (const auto sample = source.next()) {
    if (sample->label == labels::kMarkers) {
      const Pose robot = std::get<PoseSample>(sample->reading).T_odom_robot.mean;
      judged.worst_robot_m =
          std::max(judged.worst_robot_m, (robot.position - truth.at(sample->time).position).norm());
    }
    if (sample->label != labels::kPanel) continue;
    ++judged.images;
    const auto& seen = std::get<PanelSample>(sample->reading);
    const Pose T_odom_camera = truth.at(sample->time) * seen.T_robot_camera;
    for (const SeenPanel& panel : seen.panels) {
      ++judged.panels;
      const Pose T_camera_panel =
          T_odom_camera.inverse() * panels[static_cast<std::size_t>(panel.panel)].T_odom_panel;
      const Vector6d error = test::poseError(panel.T_camera_panel.pose, T_camera_panel);
      judged.worst_m = std::max(judged.worst_m, error.head<3>().norm());
      judged.worst_rad = std::max(judged.worst_rad, error.tail<3>().norm());
      judged.mean_nees += normalizedSquare(panel.T_camera_panel.covariance, error);
    }
  }
  judged.mean_nees /= judged.panels;
  return judged;
}

TEST(Landmarks, OfTwoPanelsAreWhereTruthHasThem) {
  const Judged judged = judge(simulate(test::scratchFolder(), false, {}));
  EXPECT_EQ(judged.images, 8);
  EXPECT_GE(judged.panels, 14);
  EXPECT_LT(judged.worst_m, 0.02);  // at 3 m, partly from three markers at the image's border
  EXPECT_LT(judged.worst_rad, radians(1.0));
  // 6 expected of each panel; a mean of 14 has sigma 0.93, and the edge fit's own error is stated cautiously.
  EXPECT_LT(judged.mean_nees, 10);
  EXPECT_LT(judged.worst_robot_m, 0.5);  // single markers
}

TEST(Landmarks, OfAPairAreBetter) {
  const Judged judged = judge(simulate(test::scratchFolder(), true, {}));
  EXPECT_EQ(judged.images, 8);
  EXPECT_LT(judged.worst_m, 0.01);
  EXPECT_LT(judged.mean_nees, 10);
}

TEST(Landmarks, OfJpegImagesAreNearlyAsGood) {
  const auto folder = test::scratchFolder();
  const RecordingFiles files = simulate(folder, false, {ImageFormat::Kind::jpeg, 90});
  EXPECT_TRUE(fs::exists(files.images / "CAMERA_0007.jpg"));
  EXPECT_FALSE(fs::exists(files.images / "CAMERA_0007.png"));
  const Judged judged = judge(files);
  EXPECT_EQ(judged.images, 8);
  EXPECT_LT(judged.worst_m, 0.03);
}

}  // namespace
}  // namespace fathom
