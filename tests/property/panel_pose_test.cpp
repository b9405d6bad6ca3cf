// The joint solution against random truth: corners projected, noise of a known covariance added.
#include "fiducials/panel_pose.h"

#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "core/random.h"
#include "fiducials/single_marker_pose.h"
#include "support/detections.h"

namespace fathom {
namespace {
using test::cornerCovariance;
using test::detectionsOf;
using test::gridPanel;
using test::poseError;

const CameraModel& camera() {
  static const CameraModel model = [] {
    CameraModel m;
    m.fx_px = 548.7, m.fy_px = 548.4, m.cx_px = 319.1, m.cy_px = 244.2;
    m.k1 = 0.14, m.k2 = -0.02, m.p1 = 5e-4, m.p2 = -7e-4;
    return m;
  }();
  return model;
}

Pose randomView(Random& random) {
  Pose view = test::lookingAtPanel(random.uniform(1.5, 4.0), random.uniform(0, 0.7), random.uniform(0, 6.28),
                                   random.uniform(-0.5, 0.5));
  view.position += Vector3d(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0);
  return view;
}

TEST(PanelPose, IsExactWithoutNoise) {
  Random random(1);
  for (const auto& [columns, rows] : {std::pair(1, 1), {2, 1}, {4, 3}})
    for (int i = 0; i < 20; ++i) {
      const PanelMap map = gridPanel(columns, rows);
      const Pose truth = randomView(random);
      auto detections = detectionsOf(map, camera(), truth, 0.1, random);
      for (std::size_t k = 0; k < detections.size(); ++k)
        detections[k].corners_px = test::trueCorners(map.markers[k], camera(), truth);
      const auto estimate = solvePanelPose(detections, map, camera());
      ASSERT_TRUE(estimate.solved) << estimate.why_not;
      // A single distant marker is ambiguous to within rounding where it faces the camera.
      EXPECT_LT(poseError(estimate.T_camera_panel.pose, truth).norm(), columns * rows == 1 ? 1e-4 : 1e-6);
      EXPECT_EQ(estimate.inlier_count, columns * rows);
      const auto mean = meanOfMarkers(detections, map, camera());
      EXPECT_LT(poseError(*mean, truth).norm(), 0.05);
    }
}

TEST(PanelPose, CovarianceIsHonestAndNothingFlips) {
  Random random(2);
  const PanelMap map = gridPanel(2, 2);
  double nees = 0, joint = 0, averaged = 0;
  constexpr int kRuns = 400;
  for (int i = 0; i < kRuns; ++i) {
    const Pose truth = randomView(random);
    const auto detections = detectionsOf(map, camera(), truth, 0.2, random);
    const auto estimate = solvePanelPose(detections, map, camera());
    ASSERT_TRUE(estimate.solved);
    const Vector6d error = poseError(estimate.T_camera_panel.pose, truth);
    EXPECT_LT(error.tail<3>().norm(), radians(4)) << "a flip in run " << i;
    nees += normalizedSquare(estimate.T_camera_panel.covariance, error) / kRuns;
    joint += error.tail<3>().squaredNorm() / kRuns;
    averaged +=
        std::pow(angleBetween(meanOfMarkers(detections, map, camera())->rotation, truth.rotation), 2) / kRuns;
  }
  // The mean of 400 chi-squares of 6 degrees of freedom scatters by 0.17; sigma grows in one run in a
  // hundred.
  EXPECT_NEAR(nees, 6.0, 0.6);
  EXPECT_LT(5 * std::sqrt(joint), std::sqrt(averaged));
}

TEST(PanelPose, SurvivesMisreadAndMovedMarkers) {
  Random random(3);
  const PanelMap map = gridPanel(4, 3);
  for (int i = 0; i < 60; ++i) {
    const Pose truth = randomView(random);
    auto detections = detectionsOf(map, camera(), truth, 0.15, random);
    // Two ids swapped, one marker moved by 5 cm, one somewhere else altogether.
    std::swap(detections[0].corners_px, detections[7].corners_px);
    Marker moved = map.markers[3];
    moved.T_panel_marker.position.x() += 0.05;
    detections[3].corners_px = test::trueCorners(moved, camera(), truth);
    for (Vector2d& corner : detections[10].corners_px)
      corner = Vector2d(200, 150) + 0.5 * (corner - detections[10].corners_px[0]);
    const auto estimate = solvePanelPose(detections, map, camera());
    ASSERT_TRUE(estimate.solved);
    EXPECT_LT(poseError(estimate.T_camera_panel.pose, truth).head<3>().norm(), 0.02);
    EXPECT_EQ(estimate.inlier_count, 8);
    for (const MarkerFit& fit : estimate.markers)
      EXPECT_EQ(fit.inlier,
                fit.detection != 0 && fit.detection != 7 && fit.detection != 3 && fit.detection != 10);
  }
}

TEST(PanelPose, ScaleGrowsWhereCornersAreWorseThanTheySay) {
  Random random(4);
  const PanelMap map = gridPanel(3, 2);
  const Pose truth = randomView(random);
  auto detections = detectionsOf(map, camera(), truth, 0.6, random);
  for (auto& detection : detections) detection.covariance_px2 = cornerCovariance(0.1);
  const auto estimate = solvePanelPose(detections, map, camera());
  ASSERT_TRUE(estimate.solved);
  EXPECT_NEAR(estimate.sigma_scale, 6.0, 2.0);
  EXPECT_EQ(estimate.inlier_count, 6);
  EXPECT_NEAR(estimate.rms_px, 0.6, 0.2);
}

TEST(PanelPose, TellsWhereTwoPosesExplainASmallMarker) {
  // 4 m away a marker of 0.18 m is 25 px wide: perspective is weak, and its mirror image explains it too.
  Random random(5);
  const PanelMap one = gridPanel(1, 1), twelve = gridPanel(4, 3);
  int ambiguous = 0, near = 0;
  constexpr int kRuns = 50;
  for (int i = 0; i < kRuns; ++i) {
    const Pose truth = test::lookingAtPanel(4, radians(12), random.uniform(0, 6.28));
    const auto estimate = solvePanelPose(detectionsOf(one, camera(), truth, 0.2, random), one, camera());
    ASSERT_TRUE(estimate.solved);
    if (estimate.isAmbiguous()) {
      ++ambiguous;
      const double first = angleBetween(estimate.T_camera_panel.pose.rotation, truth.rotation);
      const double second = angleBetween(estimate.alternative->T_camera_panel.rotation, truth.rotation);
      near += std::min(first, second) < radians(10);
    }
    EXPECT_FALSE(
        solvePanelPose(detectionsOf(twelve, camera(), truth, 0.2, random), twelve, camera()).isAmbiguous());
  }
  EXPECT_GT(ambiguous, kRuns / 2);
  EXPECT_GT(near, ambiguous * 3 / 4);
}

TEST(PanelPose, SaysWhyNot) {
  const PanelMap map = gridPanel(2, 1);
  EXPECT_FALSE(PanelPoseEstimate().solved);
  EXPECT_FALSE(solvePanelPose({}, map, camera()).solved);
  Detection stranger;
  stranger.family = "tag36h11";
  const auto estimate = solvePanelPose({stranger}, map, camera());
  EXPECT_FALSE(estimate.solved);
  EXPECT_EQ(estimate.why_not, "no marker of the map is seen");
  EXPECT_FALSE(meanOfMarkers({stranger}, map, camera()));
  stranger.family = map.markers[0].family;  // four times the same corner
  EXPECT_FALSE(solvePanelPose({stranger}, map, camera()).solved);
}

/// Numeric check of both conversions: samples of the pose, converted one by one, scatter as they say.
TEST(UncertainPose, ConvertsToMrptAndToTheRobot) {
  Random random(6);
  UncertainPose panel{randomView(random), Matrix6d::Zero()};
  panel.pose.rotation *= expSO3<double>({0.3, 0.5, 0.2});
  Matrix6d root = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) root(i, j) = (i < 3 ? 0.01 : 0.003) * random.uniform(-1, 1);
  panel.covariance = root * root.transpose();
  const Pose T_odom_panel{rotationFromYawPitchRoll(2.9, 0.1, 1.6), {6, 0.4, -4}};
  const Pose T_robot_camera{rotationFromYawPitchRoll(-1.6, 0.1, -1.5), {0.35, 0, 0.05}};
  const UncertainPose robot = robotPose(panel, T_odom_panel, T_robot_camera);
  const YawPitchRollPose mrpt_panel = panel.toYawPitchRoll();

  Matrix6d robot_scatter = Matrix6d::Zero(), mrpt_scatter = Matrix6d::Zero();
  constexpr int kSamples = 20000;
  for (int n = 0; n < kSamples; ++n) {
    Vector6d step;
    for (Eigen::Index i = 0; i < 6; ++i) step[i] = random.normal();
    step = root * step;
    const Pose sample{panel.pose.rotation * expSO3<double>(step.tail<3>()),
                      panel.pose.position + step.head<3>()};
    const Vector6d robot_error =
        poseError(robot.pose, T_odom_panel * sample.inverse() * T_robot_camera.inverse());
    robot_scatter += robot_error * robot_error.transpose() / kSamples;
    Vector6d mrpt_error;
    mrpt_error.head<3>() = step.head<3>();
    const Vector3d mean_angles = yawPitchRollFromRotation(panel.pose.rotation);
    const Vector3d angles = yawPitchRollFromRotation(sample.rotation);
    for (Eigen::Index i = 0; i < 3; ++i) mrpt_error[3 + i] = wrapAngle(angles[i] - mean_angles[i]);
    mrpt_scatter += mrpt_error * mrpt_error.transpose() / kSamples;
  }
  // 20000 samples: 1 % of the largest entries, and as much from the angles' curvature.
  EXPECT_LT((robot_scatter - robot.covariance).norm(), 0.03 * robot.covariance.norm());
  EXPECT_LT((mrpt_scatter - mrpt_panel.covariance).norm(), 0.03 * mrpt_scatter.norm());
  EXPECT_LT((mrpt_panel.mean.position - panel.pose.position).norm(), 1e-12);
}

const Pose kNarrowPair{expSO3<double>({0.01, -0.03, 0.02}), {0.15, 0.01, -0.02}};
/// Turned towards what is 3 m away.
const Pose kWidePair{expSO3<double>({0.01, -0.45, 0.02}), {1.4, 0.01, 0.2}};

/// A pair of cameras with different lenses.
std::vector<CameraDetections> pairOf(const PanelMap& map, const Pose& T_left_panel, double sigma_px,
                                     Random& random, const Pose& T_left_right = kNarrowPair) {
  CameraModel right = camera();
  right.fx_px += 12;
  right.cy_px -= 7;
  right.k1 = -0.05;
  return {{detectionsOf(map, camera(), T_left_panel, sigma_px, random), camera(), {}},
          {detectionsOf(map, right, T_left_right.inverse() * T_left_panel, sigma_px, random), right,
           T_left_right}};
}

TEST(PanelPose, OfAPairIsConsistentAndBetterThanOfItsCameras) {
  Random random(11);
  const PanelMap map = gridPanel(2, 1);
  double nees = 0, mono_m = 0, pair_m = 0;
  constexpr int kRuns = 200;
  for (int i = 0; i < kRuns; ++i) {
    const Pose truth = randomView(random);
    const auto pair = pairOf(map, truth, 0.2, random);
    const auto estimate = solvePanelPose(pair, map);
    ASSERT_TRUE(estimate.solved) << estimate.why_not;
    EXPECT_EQ(estimate.markers.size(), 4U);
    EXPECT_EQ(estimate.markers[3].camera, 1U);
    EXPECT_EQ(estimate.markers[3].detection, 1U);
    const Vector6d error = poseError(estimate.T_camera_panel.pose, truth);
    nees += normalizedSquare(estimate.T_camera_panel.covariance, error) / kRuns;
    pair_m += error.head<3>().norm() / kRuns;
    const auto mono = solvePanelPose(pair[0].detections, map, camera());
    mono_m += poseError(mono.T_camera_panel.pose, truth).head<3>().norm() / kRuns;
  }
  // Chi-square of 6 a run: a mean over 200 has sigma sqrt(12/200) = 0.245; four sigma, and linearization.
  EXPECT_NEAR(nees, 6.0, 1.1);
  EXPECT_LT(pair_m, 0.7 * mono_m);
}

TEST(PanelPose, TheOtherCameraTellsMirrorImagesApart) {
  Random random(12);
  const PanelMap map = gridPanel(1, 1);
  int ambiguous_alone = 0, ambiguous = 0, flipped = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose truth = test::lookingAtPanel(3.0, random.uniform(0.1, 0.3), random.uniform(0, 6.28));
    const auto pair = pairOf(map, truth, 0.3, random, kWidePair);
    ambiguous_alone += solvePanelPose(pair[0].detections, map, camera()).isAmbiguous() ? 1 : 0;
    const auto estimate = solvePanelPose(pair, map);
    ambiguous += estimate.isAmbiguous() ? 1 : 0;
    if (estimate.isAmbiguous()) continue;
    flipped += angleBetween(estimate.T_camera_panel.pose.rotation, truth.rotation) > 0.15 ? 1 : 0;
  }
  EXPECT_GT(ambiguous_alone, 20);
  EXPECT_LT(ambiguous, ambiguous_alone / 4);
  EXPECT_LE(flipped, 1);
}

}  // namespace
}  // namespace fathom
