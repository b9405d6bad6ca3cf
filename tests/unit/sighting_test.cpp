// What markers in an image tell of panels and robot, against truth.
#include "landmarks/sighting.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/linear_algebra.h"
#include "fiducials/single_marker_pose.h"
#include "recording/mrpt_types.h"
#include "support/detections.h"

namespace fathom {
namespace {
using test::detectionsOf;
using test::gridPanel;
using test::poseError;

const CameraModel kSightedBy{
    .width_px = 640, .height_px = 480, .fx_px = 555, .fy_px = 553, .cx_px = 321, .cy_px = 245, .k1 = -0.04};
const Pose kT_robot_camera{rotationFromYawPitchRoll(radians(-90), 0, radians(-92)), {0.35, 0.02, 0.05}};

/// Two panels side by side, as a camera between them sees them.
struct SightedScene {
  std::vector<PanelMap> panels{gridPanel(3, 2), gridPanel(2, 2, 100)};
  Pose T_odom_camera = Pose{rotationFromYawPitchRoll(0.2, 0.1, -1.6), {1, 2, -3}};
  std::vector<Pose> T_camera_panel{{test::lookingAtPanel(2.2, 0.35, 1.0)},
                                   {test::lookingAtPanel(2.6, 0.4, 2)}};
  Random random{3};

  SightedScene() {
    T_camera_panel[0].position.x() = -0.6;
    T_camera_panel[1].position.x() = 0.7;
    for (std::size_t i = 0; i < 2; ++i) panels[i].T_odom_panel = T_odom_camera * T_camera_panel[i];
  }
  Pose T_odom_robot() const { return T_odom_camera * kT_robot_camera.inverse(); }
  CameraDetections seen(double sigma_px) {
    CameraDetections seen{{}, kSightedBy, {}};
    for (std::size_t i = 0; i < 2; ++i)
      for (auto& d : detectionsOf(panels[i], kSightedBy, T_camera_panel[i], sigma_px, random))
        seen.detections.push_back(d);
    return seen;
  }
};

TEST(Sighting, TellsOfEveryPanel) {
  SightedScene scene;
  const Sighting sighting = sightingOf({scene.seen(0.1)}, kT_robot_camera, scene.panels);
  ASSERT_EQ(sighting.panels.panels.size(), 2U);
  EXPECT_TRUE(sighting.unused.empty());
  EXPECT_EQ(sighting.panels.T_robot_camera.position, kT_robot_camera.position);
  for (std::size_t i = 0; i < 2; ++i) {
    const SeenPanel& seen = sighting.panels.panels[i];
    EXPECT_EQ(seen.panel, static_cast<int>(i));
    const Vector6d error = poseError(seen.T_camera_panel.pose, scene.T_camera_panel[i]);
    // Chi-square of 6 degrees of freedom: above 26 once in five thousand.
    EXPECT_LT(normalizedSquare(seen.T_camera_panel.covariance, error), 26);
    EXPECT_LT(error.head<3>().norm(), 0.01);
  }
  EXPECT_EQ(sighting.markers.markers.size(), 10U);
}

TEST(Sighting, MeanOfMarkersIsTheRobotsPose) {
  SightedScene scene;
  const auto exact = sightingOf({scene.seen(1e-6)}, kT_robot_camera, scene.panels).robot;
  ASSERT_TRUE(exact);
  const Vector6d error = poseError(exact->T_odom_robot.mean, scene.T_odom_robot());
  EXPECT_LT(error.norm(), 1e-3);  // a single marker is near a double root of the equations that IPPE solves
  EXPECT_EQ(exact->T_odom_robot.covariance, Matrix6d(Matrix6d::Identity()));
}

TEST(Sighting, OfOnePanelTheMeanIsThePapers) {
  SightedScene scene;
  CameraDetections seen = scene.seen(0.3);
  const std::vector<PanelMap> one{scene.panels[0]};
  const auto robot = sightingOf({seen}, kT_robot_camera, one).robot;
  ASSERT_TRUE(robot);
  // The mean of six panel poses, turned around: T_odom_panel T_panel_camera T_camera_robot.
  Pose mean;
  for (int i = 0; i < 6; ++i) {
    const auto& d = seen.detections[static_cast<std::size_t>(i)];
    const Pose pose = poseOfMarker(d, 0.18, kSightedBy).front().T_camera_marker *
                      one[0].markers[static_cast<std::size_t>(i)].T_panel_marker.inverse();
    if (i == 0) mean = pose;
    mean.position += (pose.position - mean.position) / (i + 1);
    mean.rotation = slerp(mean.rotation, pose.rotation, 1.0 / (i + 1));
  }
  const Pose expected = one[0].T_odom_panel * mean.inverse() * kT_robot_camera.inverse();
  EXPECT_LT(poseError(robot->T_odom_robot.mean, expected).norm(), 1e-9);
}

TEST(Sighting, MarkersAreWhereMrptPutsThem) {
  SightedScene scene;
  const Sighting sighting = sightingOf({scene.seen(0.05)}, kT_robot_camera, scene.panels);
  const auto& markers = sighting.markers;
  for (std::size_t i = 0, k = 0; i < 2; ++i)
    for (const Marker& marker : scene.panels[i].markers) {
      const SeenMarker& seen = markers.markers.at(k++);
      EXPECT_EQ(seen.id, marker.id);
      const Vector3d centre = scene.panels[i].T_odom_panel * marker.T_panel_marker.position;
      const Pose T_odom_forward = scene.T_odom_robot() * markers.T_robot_camera_forward;
      double range = 0, yaw = 0, pitch = 0;
      toMrpt(T_odom_forward).sphericalCoordinates({centre.x(), centre.y(), centre.z()}, range, yaw, pitch);
      EXPECT_NEAR(seen.range_m, range, 6 * std::sqrt(seen.covariance(0, 0)));
      EXPECT_NEAR(seen.yaw_rad, yaw, 6 * std::sqrt(seen.covariance(1, 1)));
      EXPECT_NEAR(seen.pitch_rad, pitch, 6 * std::sqrt(seen.covariance(2, 2)));
      EXPECT_LT(std::abs(seen.range_m - range), 0.01);
      EXPECT_LT(std::abs(seen.pitch_rad - pitch), 0.002);
      EXPECT_GT(std::abs(yaw) + std::abs(pitch), 0.02);  // or the test would see no wrong sign
    }
}

// The covariance against samples drawn from the panel's.
TEST(Sighting, MarkersCovarianceIsThePanelPoses) {
  SightedScene scene;
  const Sighting sighting = sightingOf({scene.seen(0.5)}, kT_robot_camera, scene.panels);
  const auto& [pose, covariance] = sighting.panels.panels[0].T_camera_panel;
  const Matrix6d root = covariance.llt().matrixL();
  const Marker& marker = scene.panels[0].markers[4];
  const SeenMarker& seen = sighting.markers.markers[4];
  Matrix3d sum = Matrix3d::Zero();
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    Vector6d step;
    for (double& element : step) element = scene.random.normal();
    step = root * step;
    const Pose drawn{pose.rotation * expSO3<double>(step.tail<3>()), pose.position + step.head<3>()};
    const Vector3d p = forwardFrame().inverse() * (drawn * marker.T_panel_marker.position);
    const Vector3d offset(p.norm() - seen.range_m, std::atan2(p.y(), p.x()) - seen.yaw_rad,
                          -std::asin(p.z() / p.norm()) - seen.pitch_rad);
    sum += offset * offset.transpose();
  }
  const Matrix3d drawn = sum / kDraws;
  const Vector3d sigma = seen.covariance.diagonal().cwiseSqrt();
  // A sampled variance of 4000 draws scatters by sqrt(2/4000) = 2.2 %: five of it.
  EXPECT_LT(((drawn - seen.covariance).array() / (sigma * sigma.transpose()).array()).abs().maxCoeff(), 0.12);
}

TEST(Sighting, WhatCouldBeItsMirrorImageIsNotUsed) {
  Random random(5);
  const std::vector<PanelMap> one{gridPanel(1, 1)};
  int unused = 0;
  for (int i = 0; i < 50; ++i) {
    const Pose truth = test::lookingAtPanel(4.0, 0.15, random.uniform(0, 6.28));
    const Sighting sighting = sightingOf(
        {{detectionsOf(one[0], kSightedBy, truth, 0.3, random), kSightedBy, {}}}, kT_robot_camera, one);
    EXPECT_TRUE(sighting.robot) << "the paper's mean takes what it gets";
    EXPECT_EQ(sighting.panels.panels.size() + sighting.unused.size(), 1U);
    EXPECT_EQ(sighting.markers.markers.size(), sighting.panels.panels.size());
    if (sighting.unused.empty()) continue;
    ++unused;
    EXPECT_EQ(sighting.unused[0].why, kAmbiguous);
    EXPECT_EQ(sighting.unused[0].panel, 0);
  }
  EXPECT_GT(unused, 40);
}

TEST(Sighting, OfNothingIsEmpty) {
  SightedScene scene;
  for (const auto& cameras : {std::vector<CameraDetections>{}, {{{}, kSightedBy, {}}}}) {
    const Sighting sighting = sightingOf(cameras, kT_robot_camera, scene.panels);
    EXPECT_FALSE(sighting.robot);
    EXPECT_TRUE(sighting.panels.panels.empty());
    EXPECT_TRUE(sighting.markers.markers.empty());
    EXPECT_TRUE(sighting.unused.empty());
  }
}

}  // namespace
}  // namespace fathom
