// A camera by itself above a pool: how much water there is over a panel is found from the panel's markers
// alone, and named, beside other ways in which lines of sight may be off.
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/candidate.h"
#include "diagnosis/diagnosis.h"
#include "support/diagnosis_runs.h"
#include "support/effects_from.h"
#include "support/sanitized.h"

namespace fathom {
namespace {

constexpr double kWater_m = 0.6;

/// From 1.4 to 2.4 m over the panel, up to 40 degrees off the vertical and on all sides of it, looking at it.
Pose abovePool(double t_s) {
  const Vector3d position(1.1 * std::sin(0.37 * t_s), 0.9 * std::sin(0.29 * t_s + 1.0),
                          1.9 + 0.5 * std::sin(0.47 * t_s));
  const Vector3d aim(0.2 * std::sin(0.7 * t_s), 0.2 * std::sin(0.53 * t_s), 0);
  const double turned_rad = 0.5 * std::sin(0.31 * t_s);
  const Vector3d forward = (aim - position).normalized();
  const Vector3d level(std::cos(turned_rad), -std::sin(turned_rad), 0);
  const Vector3d right = (level - level.dot(forward) * forward).normalized();
  Pose T_odom_camera;
  T_odom_camera.rotation << right, forward.cross(right), forward;
  T_odom_camera.position = position;
  return T_odom_camera;
}

/// The panel lies face up at odom's origin; nothing is known of the path.
test::BatchRun poolRun(std::uint64_t seed) {
  constexpr double kDuration_s = 40;
  test::BatchRun run(kDuration_s, test::pathOf(kDuration_s, abovePool));
  run.seed = seed;
  run.vehicle.ins.reset();
  run.vehicle.dvl.reset();
  run.vehicle.depth.reset();
  run.vehicle.camera->T_robot_camera = {};
  run.vehicle.camera->model.above_water = true;
  run.panel.T_odom_panel = {};
  return run;
}

const EffectEstimate& waterOf(const std::vector<EffectEstimate>& estimates) {
  return *std::find_if(estimates.begin(), estimates.end(), [](const EffectEstimate& e) {
    return e.scalar == kEffectOffsets[kEffectIndex<FlatWaterSurface>];
  });
}

// Each parameter within 3.5 sigma, of which a surface that is tilted and of another index shows all.
TEST(PoolRecording, WaterIsEstimatedWithinItsSigma) {
  test::BatchRun run = poolRun(1);
  run.effects = test::effectsFrom(
      "{id: flat-water-surface, water_m: 0.6, tilt_deg: 0.7, tilt_y_deg: -0.4, water_index: 1.336}");
  const BatchInput input = run.input();
  ASSERT_FALSE(input.data.hasMotion());
  const BatchEstimate estimate = estimateBatch(input.data, input.start, test::estimating(run.effects));
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  ASSERT_EQ(estimate.effects.size(), 4U);
  for (const EffectEstimate& e : estimate.effects)
    EXPECT_LT(std::abs(e.value - run.effects.values[e.scalar]), 3.5 * e.sigma)
        << parameterOf(e.scalar).name << " " << e.value << " sigma " << e.sigma;
  // By a fit of its own, of a pinhole and two layers, sigma is 0.0018.
  EXPECT_LT(waterOf(estimate.effects).sigma, 0.004);
}

// Nothing else that bends lines of sight does so about the vertical: a focal length leaves 0.71 px of 0.71,
// with a distortion 0.65, where corners are good to 0.15.
TEST(PoolRecording, DiagnosisNamesTheWater) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  test::BatchRun run = poolRun(2);
  run.effects.add<FlatWaterSurface>({kWater_m, 0, 0, 0});
  const Diagnosis found = diagnose(run.input());
  EXPECT_EQ(found.verdict, Verdict::explained) << found.why;
  ASSERT_EQ(found.effects.size(), 1U) << found.why;
  EXPECT_EQ(nameOf(found.effects[0].candidate), "flat-water-surface") << found.why;
  const EffectEstimate& water = waterOf(found.effects[0].estimates);
  EXPECT_NEAR(water.value, kWater_m, 3 * water.sigma);
  EXPECT_LT(water.sigma, 0.02);
  for (const Alternatives& set : found.alternatives)
    for (const Candidate& candidate : set.candidates)
      EXPECT_NE(candidate.effect, kEffectIndex<FlatPortRefraction>) << found.why;
}

// A dry pool: nothing is named.
TEST(PoolRecording, DiagnosisNamesNoWaterThatIsNotThere) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  const Diagnosis found = diagnose(poolRun(3).input());
  EXPECT_EQ(found.verdict, Verdict::none) << found.why;
  EXPECT_TRUE(found.effects.empty()) << found.why;
}

// It is no candidate where the vehicle file says nothing of a camera above water.
TEST(PoolRecording, WaterCanShowToCamerasAboveItAlone) {
  for (const bool above : {false, true}) {
    test::BatchRun run = poolRun(4);
    run.vehicle.camera->model.above_water = above;
    const test::Excitation excitation(run);
    EXPECT_EQ(excitation.canShow(*findEffect("flat-water-surface")), above);
    EXPECT_TRUE(excitation.canShow(*findEffect("flat-port-refraction")));
  }
}

}  // namespace
}  // namespace fathom
