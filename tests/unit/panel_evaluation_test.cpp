// The statistics of task T_P: known errors in, known numbers out.
#include "evaluation/panel_evaluation.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(ErrorSummary, OfKnownNumbers) {
  const ErrorSummary s = summaryOf({4, 1, 3, 2});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.sigma, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.largest, 4);
  EXPECT_DOUBLE_EQ(summaryOf({5, 1, 9}).median, 5);
  EXPECT_TRUE(std::isnan(summaryOf(std::vector<double>{}).mean));
}

TEST(Bins, CoverTheirRangeOnce) {
  const auto bins = binsOf(1, 2.2, 0.5);
  ASSERT_EQ(bins.size(), 3U);
  EXPECT_DOUBLE_EQ(bins[2].high, 2.2);
  for (const double value : {1.0, 1.3, 1.5, 1.99, 2.0, 2.2})
    EXPECT_EQ(std::count_if(bins.begin(), bins.end(), [&](const Bin& b) { return b.contains(value); }), 1);
  EXPECT_TRUE(bins[1].contains(1.5));
  const auto single = binsOf(2, 2, 0.5);
  ASSERT_EQ(single.size(), 1U);
  EXPECT_TRUE(single[0].contains(2));
  EXPECT_EQ(binsOf(0, radians(60), radians(15)).size(), 4U);  // rounding makes no fifth
}

/// A panel seen from 2 m, its normal turned by `tilt` from the line of sight.
Pose tilted(double tilt) {
  CameraView view;
  view.range_m = 2;
  view.tilt_rad = tilt;
  view.azimuth_rad = 0.7;
  return view.T_panel_camera().inverse();
}

TEST(PanelPoseError, IsDistanceAndAngle) {
  const Pose truth = tilted(radians(20));
  const Pose estimate{truth.rotation * expSO3<double>({0, radians(3), 0}),
                      truth.position + Vector3d(0.03, 0, -0.04)};
  const PanelPoseError error = panelPoseError(estimate, truth);
  EXPECT_NEAR(error.position_m, 0.05, 1e-12);
  EXPECT_NEAR(degrees(error.angle_rad), 3, 1e-9);
  EXPECT_FALSE(error.flipped);
  EXPECT_TRUE(error.exists());
  EXPECT_FALSE(PanelPoseError().exists());
}

TEST(PanelPoseError, TellsAFlip) {
  const Pose truth = tilted(radians(12));
  const Pose mirrored = mirrorImage(truth, Vector3d::Zero());
  EXPECT_NEAR(degrees(angleBetween(truth.rotation, mirrored.rotation)), 24, 1e-6);
  EXPECT_TRUE(isFlipped(mirrored, truth));
  const Vector3d way = logSO3<double>(truth.rotation.transpose() * mirrored.rotation);
  const auto between = [&](double share) {
    return Pose{truth.rotation * expSO3<double>(share * way), truth.position};
  };
  EXPECT_FALSE(isFlipped(between(0.45), truth));
  EXPECT_TRUE(isFlipped(between(0.55), truth));
  // Nearly frontal: the mirror image is no other pose.
  const Pose frontal = tilted(radians(4));
  EXPECT_FALSE(isFlipped(mirrorImage(frontal, Vector3d::Zero()), frontal));
  const auto off = [&](double angle_deg) {
    return Pose{truth.rotation * expSO3<double>({0, 0, radians(angle_deg)}), truth.position};
  };
  EXPECT_FALSE(isFlipped(off(29), truth));
  EXPECT_TRUE(isFlipped(off(31), truth));
}

TEST(Nees, OfGaussianErrorsIsSix) {
  Random random(1);
  Matrix6d root = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) root(i, j) = (i == j ? 0.01 : 0.004) * random.uniform(0.5, 1);
  const UncertainPose estimate{tilted(radians(30)), root * root.transpose()};
  double mean = 0, twice = 0;
  constexpr int kSamples = 4000;
  for (int n = 0; n < kSamples; ++n) {
    Vector6d white;
    for (Eigen::Index i = 0; i < 6; ++i) white[i] = random.normal();
    const auto nees = [&](const Vector6d& error) {
      const Pose& p = estimate.pose;
      const Pose truth{p.rotation * expSO3<double>(error.tail<3>()), p.position + error.head<3>()};
      return neesOf(estimate, truth);
    };
    mean += nees(root * white) / kSamples;
    twice += nees(2.0 * root * white) / kSamples;
  }
  EXPECT_NEAR(mean, 6, 0.25);  // the mean of 4000 chi-squares of 6 scatters by 0.055: 4.5 sigma
  EXPECT_NEAR(twice, 24, 1.0);
}

PanelViewResult result(double range_m, double averaged_m, double joint_m, double nees = 6) {
  PanelViewResult r;
  r.view.range_m = range_m;
  r.view.tilt_rad = radians(10 * range_m);
  r.averaged = {averaged_m, radians(10 * averaged_m), false};
  r.joint = {joint_m, radians(10 * joint_m), false};
  r.nees = nees;
  return r;
}

TEST(PanelSummary, OfKnownErrors) {
  std::vector<PanelViewResult> results{result(1.2, 0.4, 0.1, 4), result(1.4, 0.2, 0.05, 5),
                                       result(2.0, 0.9, 0.3, 9), result(4.0, 0.5, kNone, kNone)};
  results[2].joint.flipped = results[2].ambiguous = true;
  results[0].averaged.flipped = true;
  const PanelSummary s = summaryOf(results);
  EXPECT_EQ(s.views, 4U);
  EXPECT_EQ(s.joint.no_pose, 1U);
  EXPECT_EQ(s.averaged.no_pose, 0U);
  EXPECT_EQ(s.joint.position_m.count, 3U);
  EXPECT_EQ(s.averaged.position_m.count, 3U);  // compared where both have a pose
  EXPECT_NEAR(s.averaged.position_m.mean, 0.5, 1e-12);
  EXPECT_NEAR(s.joint.position_m.mean, 0.15, 1e-12);
  EXPECT_NEAR(s.position_ratio, 0.5 / 0.15, 1e-9);
  EXPECT_NEAR(s.angle_ratio, 0.5 / 0.15, 1e-9);
  EXPECT_EQ(s.joint.flipped, 1U);
  EXPECT_EQ(s.averaged.flipped, 1U);
  EXPECT_EQ(s.ambiguous, 1U);
  EXPECT_EQ(s.flipped_unsaid, 0U);
  EXPECT_EQ(s.nees.count, 2U);
  EXPECT_NEAR(s.nees.mean, 4.5, 1e-12);
  results[2].ambiguous = false;
  EXPECT_EQ(summaryOf(results).flipped_unsaid, 1U);

  const auto ranges = byRange(results, {});
  ASSERT_EQ(ranges.size(), 6U);
  EXPECT_EQ(ranges[0].summary.views, 2U);
  EXPECT_EQ(ranges[2].summary.views, 1U);
  EXPECT_EQ(ranges[5].summary.joint.no_pose, 1U);
  EXPECT_TRUE(std::isnan(ranges[3].summary.joint.position_m.mean));
  const auto tilts = byTilt(results, {});
  ASSERT_EQ(tilts.size(), 4U);
  EXPECT_EQ(tilts[0].summary.views, 2U);
  EXPECT_EQ(tilts[1].summary.views, 1U);
}

TEST(EvaluatePanel, RefusesWhatCannotBe) {
  const std::string source = FATHOM_SOURCE_DIR;
  const Vehicle vehicle = readVehicle(source + "/config/rov.yaml");
  const Environment water = readEnvironment(source + "/config/water_clear.yaml");
  PanelEvaluationOptions options;
  options.views = 1;
  EXPECT_THROW(evaluatePanel({}, vehicle, water, options), std::invalid_argument);
}

}  // namespace
}  // namespace fathom
