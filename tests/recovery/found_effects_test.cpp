// Clocks that drift, panels that are not as drawn, edges and light that are elsewhere: hidden in recordings
// without images, found again.
#include <gtest/gtest.h>

#include <set>

#include "diagnosis/diagnosis.h"
#include "effects/sensor_kinds.h"
#include "support/effects_from.h"
#include "support/flawed_runs.h"
#include "support/sanitized.h"

namespace fathom {
namespace {

/// Each parameter within 3.5 sigma, and large beside that.
void expectEstimated(test::BatchRun run, const std::string& effects, double least_sigmas) {
  run.effects = test::effectsFrom(effects);
  const BatchInput input = run.input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, test::estimating(run.effects));
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  ASSERT_FALSE(estimate.effects.empty());
  for (const EffectEstimate& e : estimate.effects) {
    const double truth = run.effects.values[e.scalar];
    EXPECT_LT(std::abs(e.value - truth), 3.5 * e.sigma)
        << effects << " scalar " << e.scalar << ": " << e.value << " sigma " << e.sigma;
    EXPECT_GT(std::abs(truth), least_sigmas * e.sigma) << effects << " scalar " << e.scalar << " " << e.sigma;
  }
}

test::BatchRun richDive(double duration_s, bool pixels = false) {
  test::BatchRun run = test::richRun(1, duration_s);
  run.pixels = pixels;
  return run;
}

TEST(FoundEffects, ClockDriftIsEstimatedWithinItsSigma) {
  expectEstimated(richDive(40), "{id: clock-drift, sensor: CAMERA, rate_ppm: 300}", 5);
  expectEstimated(richDive(40), "{id: clock-drift, sensor: INS, rate_ppm: -300}", 5);
}

TEST(FoundEffects, EdgeBiasIsEstimatedWithinItsSigma) {
  expectEstimated(richDive(24), "{id: edge-bias, offset_px: 0.05}", 5);
}

TEST(FoundEffects, PanelShapeIsEstimatedWithinItsSigma) {
  expectEstimated(richDive(24),
                  "{id: panel-shape, stretch_x: 0.003, stretch_y: -0.002, shear: 0.002, fold_deg: 0.6, "
                  "twist_m: 0.004, bend_m: -0.005}",
                  3);
}

TEST(FoundEffects, IlluminationGradientIsEstimatedWithinItsSigma) {
  expectEstimated(richDive(12, true), "{id: illumination-gradient, gradient_per_m: [0.08, -0.05]}", 5);
}

/// The only effect that a diagnosis states.
FoundEffect onlyFound(const test::BatchRun& run) {
  const Diagnosis found = diagnose(run.input());
  EXPECT_EQ(found.effects.size(), 1U) << found.why;
  return found.effects.empty() ? FoundEffect{} : found.effects[0];
}

double sigmasOff(const FoundEffect& found, std::size_t scalar, double truth) {
  for (const EffectEstimate& e : found.estimates)
    if (e.scalar == kEffectOffsets[found.candidate.effect] + scalar)
      return std::abs(e.value - truth) / e.sigma;
  return 1e9;
}

TEST(FoundEffects, DiagnosisNamesWhoseClockDrifts) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  test::BatchRun run = richDive(36);
  run.effects = test::effectsFrom("{id: clock-drift, sensor: CAMERA, rate_ppm: 600}");
  const FoundEffect found = onlyFound(run);
  EXPECT_EQ(nameOf(found.candidate), "clock-drift CAMERA");
  EXPECT_LT(sigmasOff(found, 1, 600), 4);
}

// A camera that is fast is, but for the DVL's few readings, an INS that is slow.
TEST(FoundEffects, AClockThatMayBeAnothersIsASet) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  test::BatchRun run = richDive(60);
  run.effects = test::effectsFrom("{id: clock-drift, sensor: CAMERA, rate_ppm: 100}");
  const Diagnosis found = diagnose(run.input());
  ASSERT_EQ(found.alternatives.size(), 1U) << found.why;
  std::set<std::string> names;
  for (const Candidate& candidate : found.alternatives[0].candidates) names.insert(nameOf(candidate));
  EXPECT_TRUE(names.contains("clock-drift CAMERA") && names.contains("clock-drift INS")) << found.why;
}

TEST(FoundEffects, DiagnosisNamesEdgesThatMoved) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  test::BatchRun run = richDive(24);
  run.effects.add<EdgeBias>({0.15});
  const FoundEffect found = onlyFound(run);
  EXPECT_EQ(nameOf(found.candidate), "edge-bias");
  EXPECT_LT(sigmasOff(found, 0, 0.15), 4);
}

// By markers that are each turned about the crease, not by the effect's own equation.
TEST(FoundEffects, DiagnosisNamesAFoldedPanel) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  test::BatchRun run = richDive(24);
  run.true_panel = test::folded(run.panel, radians(1));
  const FoundEffect found = onlyFound(run);
  EXPECT_EQ(nameOf(found.candidate), "panel-shape");
  EXPECT_LT(sigmasOff(found, 3, -1.0), 4);
}

TEST(FoundEffects, DiagnosisNamesUnevenDaylight) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  test::BatchRun run = test::lightDive();
  // Markers' prints may differ by 2 %, as a gradient of 5 % per metre does from one to the next.
  run.effects.add<IlluminationGradient>({0.2, -0.3});
  const FoundEffect found = onlyFound(run);
  EXPECT_EQ(nameOf(found.candidate), "illumination-gradient");
  EXPECT_LT(sigmasOff(found, 0, 0.2), 4);
  EXPECT_LT(sigmasOff(found, 1, -0.3), 4);
}

}  // namespace
}  // namespace fathom
