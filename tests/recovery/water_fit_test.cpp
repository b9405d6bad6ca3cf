// Patches made of a known water by the equation written out anew (support/patches.h): does the fit find it?
#include "environment/water_fit.h"

#include <gtest/gtest.h>

#include "support/patches.h"
#include "support/shipped.h"

namespace fathom {
namespace {

using Gain = WaterFitOptions::Gain;

const char* const kWaters[] = {"water_clear.yaml", "water_moderate.yaml", "water_turbid.yaml"};

Environment shippedWater(const std::string& name) { return readEnvironment(test::kConfig / name); }

WaterFit fitOf(const test::MadePatches& made, Gain gain = Gain::detected) {
  WaterFitOptions options;
  options.gain = gain;
  options.start = shippedWater("water_clear.yaml");
  return fitWater(made.patches, made.log_gain.size(), options);
}

/// Every parameter's error, in its sigmas.
Vector9d errorsInSigmas(const WaterFit& fit, const Environment& truth) {
  return (waterParameters(fit.environment) - waterParameters(truth)).cwiseQuotient(fit.sigma());
}

TEST(WaterFit, FindsThreeWatersOfThreeSeeds) {
  for (const char* water : kWaters)
    for (const std::uint64_t seed : {1, 2, 3}) {
      SCOPED_TRACE(std::string(water) + " " + std::to_string(seed));
      const Environment truth = shippedWater(water);
      const WaterFit fit = fitOf(test::makePatches(truth, {}, seed));
      ASSERT_TRUE(fit.solved) << fit.why_not;
      EXPECT_FALSE(fit.gain_fitted);
      // 81 numbers: 3.5 sigma is passed by chance in one run of 26.
      EXPECT_LT(errorsInSigmas(fit, truth).cwiseAbs().maxCoeff(), 3.5);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(fit.environment.water.attenuation_per_m[c] / truth.water.attenuation_per_m[c], 1, 0.02);
        EXPECT_NEAR(fit.environment.water.veil[c] / truth.water.veil[c], 1, 0.02);
        EXPECT_NEAR(fit.chi_square_per_dof[c], 1, 0.1);  // 3000 patches: sigma 0.026
        EXPECT_NEAR(fit.excess_sigma[c], 0.001, 0.0001);
      }
      EXPECT_TRUE(fit.warnings.empty()) << fit.warnings.front();
    }
}

TEST(WaterFit, FindsTheExposureGains) {
  const Environment truth = shippedWater("water_moderate.yaml");
  test::PatchPlan plan;
  plan.log_gain_sigma = 0.1;
  const auto made = test::makePatches(truth, plan, 4);
  const WaterFit fit = fitOf(made);
  ASSERT_TRUE(fit.solved) << fit.why_not;
  EXPECT_TRUE(fit.gain_fitted);
  EXPECT_LT(errorsInSigmas(fit, truth).cwiseAbs().maxCoeff(), 3.5);
  ASSERT_EQ(fit.log_gain.size(), made.log_gain.size());
  double squares = 0;
  for (std::size_t k = 0; k < made.log_gain.size(); ++k) {
    EXPECT_NEAR(fit.log_gain[k], made.log_gain[k], 0.01);
    squares += std::pow((fit.log_gain[k] - made.log_gain[k]) / fit.log_gain_sigma[k], 2);
  }
  EXPECT_NEAR(squares / 50, 1,
              0.8);  // errors share the water's: scatter more than the 0.2 of independent ones
  const WaterFit without = fitOf(made, Gain::fixed);
  EXPECT_GT((without.environment.water.attenuation_per_m - truth.water.attenuation_per_m).norm(),
            (fit.environment.water.attenuation_per_m - truth.water.attenuation_per_m).norm());
}

TEST(WaterFit, BearsTenPercentOfMisreadPatches) {
  for (const char* water : kWaters) {
    SCOPED_TRACE(water);
    const Environment truth = shippedWater(water);
    test::PatchPlan plan;
    plan.misread_share = 0.1;
    const WaterFit fit = fitOf(test::makePatches(truth, plan, 5));
    ASSERT_TRUE(fit.solved);
    EXPECT_GT(fit.outliers, 0.07 * 3000);
    EXPECT_LT(fit.outliers, 0.13 * 3000);
    EXPECT_LT(errorsInSigmas(fit, truth).cwiseAbs().maxCoeff(), 4);
  }
}

TEST(WaterFit, SaysThatOneRangeDoesNotTellAttenuationFromVeil) {
  test::PatchPlan plan;
  plan.nearest_m = plan.farthest_m = 2;
  plan.depth_m = 0.05;
  const WaterFit fit = fitOf(test::makePatches(shippedWater("water_moderate.yaml"), plan, 6));
  ASSERT_TRUE(fit.solved);
  ASSERT_EQ(fit.warnings.size(), 3U);
  EXPECT_NE(fit.warnings[1].find("green: images from 1.98 to 2.02 m do not tell attenuation from veil"),
            std::string::npos)
      << fit.warnings[1];
  EXPECT_NE(fit.warnings[1].find("would do"), std::string::npos);
  // What it advises is enough.
  plan.farthest_m = 4;
  plan.depth_m = 0.05;
  EXPECT_TRUE(fitOf(test::makePatches(shippedWater("water_moderate.yaml"), plan, 6)).warnings.empty());
}

TEST(WaterFit, RefusesTooFewPatches) {
  EXPECT_FALSE(fitWater({}, 0).solved);
  EXPECT_EQ(fitWater({}, 0).why_not, "only 0 patches");
}

/// The parametric bootstrap: recordings made anew of the fitted water, fitted anew. What those fits scatter
/// by is the uncertainty, found without any derivative.
TEST(WaterFit, StatesTheUncertaintyThatTheBootstrapFinds) {
  test::PatchPlan plan;
  plan.patches_per_image = 20;
  plan.images = 30;
  plan.farthest_m = 3.0;
  const WaterFit fit = fitOf(test::makePatches(shippedWater("water_turbid.yaml"), plan, 7), Gain::fixed);
  ASSERT_TRUE(fit.solved);
  constexpr int kRuns = 60;
  Vector9d sum = Vector9d::Zero(), squares = Vector9d::Zero();
  int inside = 0;
  for (int run = 0; run < kRuns; ++run) {
    const WaterFit again =
        fitOf(test::makePatches(fit.environment, plan, 1000 + static_cast<std::uint64_t>(run)), Gain::fixed);
    const Vector9d p = waterParameters(again.environment);
    sum += p;
    squares += p.cwiseAbs2();
    inside += static_cast<int>((errorsInSigmas(again, fit.environment).array().abs() < 2).count());
  }
  const Vector9d scatter = (squares / kRuns - (sum / kRuns).cwiseAbs2()).cwiseSqrt();
  // A scatter of 60 runs is known to 9 %; clustering by image makes sigmas of single fits larger by up to 15
  // %.
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(fit.sigma()[i] / scatter[i], 1.05, 0.3) << i;
  EXPECT_GT(inside, 0.93 * 9 * kRuns);  // 95.4 % of normal errors are within two sigma
}

}  // namespace
}  // namespace fathom
