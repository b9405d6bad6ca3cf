// An effect outside the tree (app/examples/gyro_nonlinearity.h), which the debug preset is told of: all that
// the catalogue's effects are known by knows it. The laws of tests/property/effects_test.cpp are checked of
// it, too.
#include <gtest/gtest.h>

#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "support/batch_runs.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

TEST(ExtraEffect, CalibrationSimulatorAndFitKnowIt) {
  const EffectInfo* known = findEffect("gyro-nonlinearity");
  if (known == nullptr) GTEST_SKIP() << "this build has no effect of one's own (FATHOM_EXTRA_EFFECTS)";
  EXPECT_EQ(known->index, kEffectCount - 1) << "behind the catalogue";

  const auto file = test::scratchFolder() / "calibration.yaml";
  writeTextFile(file, "effects:\n  - {id: gyro-nonlinearity, cubic_s2_rad2: 0.8}\n");
  test::BatchRun run(12.0);
  run.effects = readCalibration(file);
  EXPECT_EQ(run.effects.values[known->first_scalar], 0.8);
  EXPECT_NE(formatCalibration(run.effects).find("gyro-nonlinearity"), std::string::npos);

  const BatchInput input = run.input();
  BatchOptions options;
  options.calibration.on.set(known->index);
  options.problem.estimate = options.calibration.on;
  const BatchEstimate estimate = estimateBatch(input.data, input.start, options);
  ASSERT_EQ(estimate.effects.size(), 1u);
  const EffectEstimate& found = estimate.effects.front();
  EXPECT_NEAR(found.value, 0.8, 4 * found.sigma);
  EXPECT_LT(found.sigma, 0.2);
}

}  // namespace
}  // namespace fathom
