// Derived samples in the stream: their order, times and labels, and that nothing else changes.
#include "landmarks/landmark_source.h"

#include "support/detections.h"
#include "support/recordings.h"
#include "support/shared_data.h"
#include "support/streams.h"

namespace fathom {
namespace {
using test::detectionsOf;
using test::drain;
using test::gridPanel;
using test::kStart;

RecordedCamera intrinsics() {
  return recordedCamera({640, 480, 555, 553, 321, 245, -0.04, 0.01, 1e-3, -1e-3, 0.002});
}

const Pose kMountedCamera{rotationFromYawPitchRoll(radians(-90), 0, radians(-92)), {0.35, 0.02, 0.05}};
const Pose kT_left_right{Matrix3d::Identity(), {0.12, 0, 0}};
const Pose kT_camera_panel = test::lookingAtPanel(2.5, 0.4, 1.0);

class LandmarkSourceTest : public testing::Test {
 protected:
  LandmarkSourceTest() {
    panels[0].T_odom_panel.position = {6, 0, -4};
    const CameraModel camera = intrinsics().model;
    found.by_file["/images/left.png"] = detectionsOf(panels[0], camera, kT_camera_panel, 0.1, random);
    found.by_file["/images/right.png"] =
        detectionsOf(panels[0], camera, kT_left_right.inverse() * kT_camera_panel, 0.1, random);
    found.by_file["/images/empty.png"] = {};
  }
  static Sample image(double t_s, const std::string& file) {
    return {after(kStart, t_s), labels::kCamera, ImageSample{kMountedCamera, intrinsics(), file}};
  }
  static Sample pair(double t_s, const std::string& left, const std::string& right) {
    return {after(kStart, t_s), labels::kStereo,
            StereoSample{kMountedCamera, kT_left_right, intrinsics(), intrinsics(), left, right}};
  }
  /// What the images tell, solved for first.
  LandmarkSource sourceOf(const std::vector<Sample>& samples) {
    test::ListSource images(samples);
    sightings = std::make_shared<Sightings>(solveSightings(imageEntries(images, {}), found, panels));
    return {std::make_unique<test::ListSource>(samples), sightings};
  }
  static std::vector<std::string> labelsOf(const std::vector<Sample>& samples) {
    std::vector<std::string> labels;
    labels.reserve(samples.size());
    for (const Sample& sample : samples) labels.push_back(sample.label);
    return labels;
  }

  Random random{7};
  std::vector<PanelMap> panels{gridPanel(3, 2)};
  Detections found;
  std::shared_ptr<const Sightings> sightings;
};

TEST_F(LandmarkSourceTest, WhatAnImageTellsFollowsIt) {
  const Sample dvl{after(kStart, 2.5), labels::kDvl, DvlSample{}};
  auto source = sourceOf({image(1, "left.png"), image(2, "empty.png"), dvl, image(3, "gone.png")});
  EXPECT_EQ(source.header().description, "a list");
  const auto samples = drain(source);
  EXPECT_EQ(labelsOf(samples), (std::vector<std::string>{"CAMERA", "MARKERS", "PANEL", "MARKER_SIGHTS",
                                                         "CAMERA", "DVL", "CAMERA"}));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(samples[i].time, after(kStart, 1));
  EXPECT_EQ(sightings->by_entry.size(), 3U);
  EXPECT_EQ(sightings->without_file, 1U);
  EXPECT_EQ(sightings->with_markers, 1U);
  EXPECT_EQ(sightings->panels_used, 1U);
  EXPECT_TRUE(sightings->panels_unused.empty());
}

TEST_F(LandmarkSourceTest, RobotAndPanelAgreeWithTruth) {
  auto source = sourceOf({image(1, "left.png")});
  const auto samples = drain(source);
  const auto& seen = std::get<PanelSample>(samples.at(2).reading).panels.at(0);
  EXPECT_LT(test::poseError(seen.T_camera_panel.pose, kT_camera_panel).head<3>().norm(), 0.01);
  const Pose T_odom_robot = panels[0].T_odom_panel * kT_camera_panel.inverse() * kMountedCamera.inverse();
  const Pose told = std::get<PoseSample>(samples.at(1).reading).T_odom_robot.mean;
  EXPECT_LT((told.position - T_odom_robot.position).norm(), 0.15);  // single markers, tilted
}

TEST_F(LandmarkSourceTest, APairIsSolvedAtOnceAndOneFileIsEnough) {
  auto source = sourceOf({pair(1, "left.png", "right.png"), pair(2, "gone.png", "right.png")});
  const auto samples = drain(source);
  ASSERT_EQ(samples.size(), 8U);
  const auto both = std::get<PanelSample>(samples[2].reading).panels.at(0).T_camera_panel;
  const auto right = std::get<PanelSample>(samples[6].reading).panels.at(0).T_camera_panel;
  EXPECT_LT(test::poseError(both.pose, kT_camera_panel).head<3>().norm(), 0.005);
  EXPECT_LT(test::poseError(right.pose, kT_camera_panel).head<3>().norm(), 0.01);
  EXPECT_LT(both.covariance(2, 2), 0.6 * right.covariance(2, 2));
  EXPECT_EQ(sightings->without_file, 1U);
}

TEST_F(LandmarkSourceTest, AmbiguousPanelsAreCounted) {
  panels = {gridPanel(1, 1)};
  Random draws(1);
  found.by_file["/images/far.png"] =
      detectionsOf(panels[0], intrinsics().model, test::lookingAtPanel(5, 0.1), 0.2, draws);
  auto source = sourceOf({image(1, "far.png")});
  EXPECT_EQ(labelsOf(drain(source)), (std::vector<std::string>{"CAMERA", "MARKERS"}));
  EXPECT_EQ(sightings->panels_unused.at(kAmbiguous), 1U);
  EXPECT_EQ(sightings->panels_used, 0U);
  EXPECT_EQ(sightings->with_markers, 1U);
}

TEST_F(LandmarkSourceTest, TheStreamCanBeRecorded) {
  auto source = sourceOf({image(1, "left.png"), pair(2, "left.png", "right.png")});
  const auto samples = drain(source);
  const auto file = test::scratchFolder() / "a_results.rawlog";
  test::writeRecording(file, samples);
  const auto back = test::readRecording(file);
  EXPECT_FALSE(back.loss);
  EXPECT_EQ(labelsOf(back.samples), labelsOf(samples));
}

}  // namespace
}  // namespace fathom
