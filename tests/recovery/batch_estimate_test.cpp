#include "estimation/batch_estimate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/linear_algebra.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "estimation/linearization.h"
#include "support/batch_runs.h"
#include "support/effects_from.h"

namespace fathom {
namespace {

double largestRaw(const Linearization& linear, Channel channel) {
  double largest = 0;
  for (const RowInfo& row : linear.rows)
    if (row.channel == channel) largest = std::max(largest, std::abs(row.raw));
  return largest;
}

/// So many effects at once that every sensor and every stage of the camera takes part.
const char* const kMany =
    "{id: dvl-scale, scale_error: 0.02}, {id: dvl-lever-arm, offset_m: [0.1, -0.05, 0.03]},"
    "{id: dvl-latency, latency_s: 0.03}, {id: gyro-scale, scale_error: 0.004},"
    "{id: ins-misalignment, rotation_deg: [0.5, -0.4, 0.3]}, {id: pressure-density, density_error_kg_m3: 8},"
    "{id: accelerometer-bias, bias_m_s2: [0.02, -0.01, 0.03]},"
    "{id: flat-port-refraction, distance_m: 0.02, glass_m: 0.01, tilt_deg: 0.5},"
    "{id: camera-latency, latency_s: 0.05}, {id: rolling-shutter, readout_s: 0.03},"
    "{id: marker-moved, marker_id: 5, offset_m: [0.01, 0.01, 0], rotation_deg: 1},"
    "{id: panel-moved, time_s: 6.5, offset_m: [0.03, 0, 0.02], rotation_deg: [0, 2, 0]},"
    "{id: water-current, current_m_s: [0.1, 0.05, 0], active_s: [3, 8]}";

// With the effects that are there, what is left of noise-free readings is what a spline with 0.2 s between
// knots cannot follow of the motion: the fastest part has 7.6 s, (0.83 rad/s · 0.2 s)² / 24 = 0.1 % of an
// acceleration of 0.6 m/s² between knots.
TEST(BatchEstimate, LeavesNothingOfReadingsWithoutNoise) {
  test::BatchRun run(12.0);
  run.noise = false;
  run.effects = test::effectsFrom(kMany);
  const BatchInput input = run.input(run.effects);
  BatchOptions options;
  options.calibration = run.effects;
  const BatchEstimate estimate = estimateBatch(input.data, input.start, options);
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  const Linearization linear = linearize(input.data, *problemAt(input.data, estimate, options), false);
  EXPECT_LT(largestRaw(linear, kChannel<Gyro>), 3e-5);
  EXPECT_LT(largestRaw(linear, kChannel<Accelerometer>), 1e-3);
  EXPECT_LT(largestRaw(linear, kChannel<Dvl>), 2e-4);
  EXPECT_LT(largestRaw(linear, kChannel<Depth>), 2.0);
  EXPECT_LT(largestRaw(linear, kChannel<Markers>), 0.02);
  for (const PathPose& pose : estimate.path)
    EXPECT_LT(poseDifference(pose.T_odom_robot.pose, run.truth(pose.t_s)).head<3>().norm(), 2e-4) << pose.t_s;
  EXPECT_TRUE(estimate.down_weighted.empty());
}

/// Each scalar's error in its sigma.
class BatchRecovery : public testing::TestWithParam<const char*> {};

TEST_P(BatchRecovery, FindsEffectsWithinTheirSigma) {
  test::BatchRun run(25.0);
  run.effects = test::effectsFrom(GetParam());
  run.seed = 7;
  const BatchInput input = run.input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, test::estimating(run.effects));
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  double smallest_share = 1.0;
  for (const EffectEstimate& e : estimate.effects) {
    EXPECT_LT(std::abs(e.value - run.effects.values[e.scalar]), 3.5 * e.sigma)
        << allEffects()[e.effect].id << " scalar " << e.scalar << " " << e.value << " sigma " << e.sigma;
    if (run.effects.values[e.scalar] != 0.0)
      smallest_share = std::min(smallest_share, e.sigma / std::abs(run.effects.values[e.scalar]));
  }
  EXPECT_LT(smallest_share, 0.2) << "too uncertain to have been found";
  for (const auto& [channel, residual] : estimate.residuals) {
    if (channel == kChannel<Prior> || residual.rows <= 100) continue;
    // A mean square over 100 rows or more: 1 ± sqrt(2/100); the expected one is of what the fit leaves.
    EXPECT_NEAR(residual.rms / residual.expected_rms, 1.0, 0.2) << nameOf(channel);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Effects, BatchRecovery,
    testing::Values("{id: dvl-scale, scale_error: 0.02}", "{id: dvl-latency, latency_s: 0.08}",
                    "{id: dvl-misalignment, rotation_deg: [0.5, -0.5, 2]}",
                    "{id: water-current, current_m_s: [0.1, 0.05, 0], active_s: [5, 20]}",
                    "{id: ins-latency, latency_s: 0.03}", "{id: pressure-density, density_error_kg_m3: 15}",
                    "{id: camera-latency, latency_s: 0.06}", "{id: rolling-shutter, readout_s: 0.03}",
                    "{id: camera-misalignment, rotation_deg: [1, -0.5, 0.7]}",
                    "{id: flat-port-refraction, distance_m: 0.05, glass_m: 0.01, tilt_deg: 1, tilt_y_deg: 0}",
                    "{id: marker-moved, marker_id: 5, offset_m: [0.012, -0.008, 0], rotation_deg: 1.5},"
                    "{id: dvl-lever-arm, offset_m: [0.15, 0, 0]}",
                    "{id: panel-moved, time_s: 12.5, offset_m: [0.05, 0, 0], rotation_deg: [0, 3, 0]}"));

// Where a window's distance and thickness can hardly be told apart one of them would be less than nothing in
// most recordings.
TEST(BatchEstimate, NothingIsThinnerThanNothing) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    test::BatchRun run(12.0);
    run.seed = seed;
    const BatchInput input = run.input();
    const BatchEstimate estimate = estimateBatch(
        input.data, input.start,
        test::estimating(
            test::effectsFrom("{id: flat-port-refraction, distance_m: 0, glass_m: 0, tilt_deg: 0}")));
    ASSERT_TRUE(estimate.succeeded) << estimate.failure;
    for (const EffectEstimate& e : estimate.effects)
      if (parameterOf(e.scalar).positive) EXPECT_GE(e.value, 0) << seed << " " << parameterOf(e.scalar).name;
  }
}

// An INS that is late by so much, or everything else that is early: the same, but for the origin of time.
// What the path follows of noise is to be the same too, else one is told from the other by chance: with knots
// that stayed where they were the costs differed by up to 2.2. What is left are the ends, and where both
// iterations stop.
TEST(BatchEstimate, DoesNotTellOneShiftOfTimeFromTheSame) {
  for (const int seed : {1, 2, 3}) {
    test::BatchRun run(25.0);
    run.seed = static_cast<std::uint64_t>(seed);
    run.effects = test::effectsFrom("{id: ins-latency, latency_s: 0.03}");
    BatchInput input = run.input();
    input.data.of<Depth>().clear();  // no effect has it late
    BatchOptions late, early;
    late.calibration = run.effects;
    early.calibration =
        test::effectsFrom("{id: camera-latency, latency_s: -0.03}, {id: dvl-latency, latency_s: -0.03}");
    const BatchEstimate a = estimateBatch(input.data, input.start, late),
                        b = estimateBatch(input.data, input.start, early);
    ASSERT_TRUE(a.succeeded && b.succeeded) << a.failure << b.failure;
    EXPECT_NEAR(a.cost, b.cost, 0.3) << seed;
  }
}

/// A quarter of the turning and moving before the panel: most of what a gyro reads is its noise.
Trajectory almostStill(double duration_s) {
  std::vector<double> times_s = test::timesBetween(0, duration_s, 0.1);
  std::vector<Pose> poses;
  const Pose from = test::beforePanel(0);
  for (const double t_s : times_s) {
    const Pose moved = from.inverse() * test::beforePanel(t_s);
    poses.push_back(from *
                    Pose{expSO3<double>(0.25 * logSO3<double>(moved.rotation)), 0.25 * moved.position});
  }
  return {times_s, poses};
}

// The same where it has to be found: a path whose knots stay while the INS's latency is looked for follows
// the noise that it had before, and an estimate ends where that is least.
TEST(BatchEstimate, FindsOneShiftOfTimeAsWellAsTheSame) {
  std::vector<double> differences;
  for (const int seed : {1, 2, 3}) {
    test::BatchRun run(40.0, almostStill(50.0));
    run.seed = static_cast<std::uint64_t>(seed);
    run.effects = test::effectsFrom("{id: ins-latency, latency_s: -0.12}");
    BatchInput input = run.input();
    input.data.of<Depth>().clear();
    input.data.of<Dvl>().clear();
    const auto of = [&](const char* effect) {
      return estimateBatch(input.data, input.start, test::estimating(test::effectsFrom(effect)));
    };
    const BatchEstimate late = of("{id: ins-latency, latency_s: 0}"),
                        early = of("{id: camera-latency, latency_s: 0}");
    ASSERT_TRUE(late.succeeded && early.succeeded) << late.failure << early.failure;
    ASSERT_EQ(late.effects.size(), 1u);
    EXPECT_NEAR(late.effects[0].sigma, early.effects[0].sigma, 0.02 * early.effects[0].sigma) << seed;
    // Their priors differ, a little of the size and by the same of all costs; and the ends.
    EXPECT_NEAR(late.effects[0].value, -early.effects[0].value, 0.5 * early.effects[0].sigma) << seed;
    EXPECT_NEAR(late.effects[0].value, -0.12, 4 * late.effects[0].sigma) << seed;
    differences.push_back(late.cost - early.cost);
    EXPECT_NEAR(differences.back(), differences.front(), 0.3) << seed;
  }
}

// A path that only its start holds: damped steps (a trust region that starts at Ceres's 1e4) take 11.
TEST(BatchEstimate, SettlesInAFewSteps) {
  test::BatchRun run(60.0);
  run.vehicle.depth.reset();
  BatchInput input = run.input();
  input.data.markers.clear();
  const BatchEstimate estimate =
      estimateBatch(input.data, input.start,
                    test::estimating(test::effectsFrom("{id: dvl-lever-arm, offset_m: [0, 0, 0]}")));
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  EXPECT_LE(estimate.iterations, 8);
}

TEST(BatchEstimate, NeedsNoNavigation) {
  test::BatchRun run(30.0);
  run.vehicle.ins.reset();
  run.vehicle.dvl.reset();
  run.vehicle.depth.reset();
  run.effects =
      test::effectsFrom("{id: marker-moved, marker_id: 6, offset_m: [0.01, 0, 0], rotation_deg: 0}");
  const BatchInput input = run.input();
  ASSERT_FALSE(input.data.hasMotion());
  const BatchEstimate estimate = estimateBatch(input.data, input.start, test::estimating(run.effects));
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  ASSERT_EQ(estimate.path.size(), 31u);
  double nees = 0;
  for (const PathPose& pose : estimate.path) {
    const Vector6d error = poseDifference(pose.T_odom_robot.pose, run.truth(pose.t_s));
    nees += normalizedSquare(pose.T_odom_robot.covariance, error) / 31.0;
  }
  EXPECT_NEAR(nees, 6.0, 4.5 * std::sqrt(12.0 / 31.0));
  for (const EffectEstimate& e : estimate.effects)
    EXPECT_LT(std::abs(e.value - run.effects.values[e.scalar]), 3.5 * e.sigma) << e.scalar;
}

// Navigation alone: odom is where the path begins, and what is not told grows with the way.
TEST(BatchEstimate, NeedsNoCamera) {
  test::BatchRun run(30.0);
  run.vehicle.camera.reset();
  const BatchInput input = run.input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  const Pose T_odom_truth = estimate.path.front().T_odom_robot.pose * run.truth(0.0).inverse();
  const PathPose& last = estimate.path.back();
  const Pose truth = T_odom_truth * run.truth(last.t_s);
  const double sigma_m = std::sqrt(last.T_odom_robot.covariance.topLeftCorner<2, 2>().trace());
  EXPECT_LT((last.T_odom_robot.pose.position - truth.position).head<2>().norm(), 4 * sigma_m);
  EXPECT_LT(sigma_m, 0.2);  // 1 cm/s of the DVL, five a second for 30 s, heading 0.001 rad/s: some cm
}

// An image without a model for what it shows must not spoil the rest, and be named.
TEST(BatchEstimate, DownWeightsAndNamesOutliers) {
  test::BatchRun run(12.0);
  BatchInput input = run.input();
  BatchMarker& wrong = input.data.markers[input.data.markers.size() / 2];
  for (Vector2d& corner : wrong.detection.corners_px) corner += Vector2d(12, -7);
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  ASSERT_TRUE(estimate.succeeded);
  ASSERT_EQ(estimate.down_weighted.size(), 1u);
  EXPECT_EQ(estimate.down_weighted[0].source.marker, std::ssize(input.data.markers) / 2);
  EXPECT_LT(estimate.down_weighted[0].weight, 0.2);
  for (const PathPose& pose : estimate.path)
    EXPECT_LT(poseDifference(pose.T_odom_robot.pose, run.truth(pose.t_s)).head<3>().norm(), 0.05);
}

TEST(BatchEstimate, DoesNotDependOnTheNumberOfThreads) {
  test::BatchRun run(6.0);
  const BatchInput input = run.input();
  std::vector<Pose> ends;
  for (const std::size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    ends.push_back(estimateBatch(input.data, input.start, {}).path.back().T_odom_robot.pose);
  }
  EXPECT_EQ(ends[0].position, ends[1].position);
  EXPECT_EQ(ends[0].rotation, ends[1].rotation);
}

TEST(BatchEstimate, SaysWhyItFails) {
  test::BatchRun run(3.0);
  const BatchEstimate none;
  EXPECT_FALSE(none.succeeded);
  EXPECT_EQ(none.failure, "not run");
  BatchInput input = run.input();
  input.start.T_odom_robot.clear();
  const BatchEstimate failed = estimateBatch(input.data, input.start, {});
  EXPECT_FALSE(failed.succeeded);
  EXPECT_NE(failed.failure.find("no path"), std::string::npos);
}

}  // namespace
}  // namespace fathom
