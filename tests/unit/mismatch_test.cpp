#include "diagnosis/mismatch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/budget_file.h"
#include "diagnosis/manoeuvre.h"
#include "effects/catalogue.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

/// A short run's estimate, and the model linearized there.
struct WhitenedRun {
  BatchInput input = test::BatchRun(6.0).input();
  BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  Linearization linear() const { return linearize(input.data, *problemAt(input.data, estimate, {})); }
};

/// The readings of all bins together.
double meanOf(const Mismatch& map) {
  double sum = 0, rows = 0;
  for (const MismatchBin& bin : map.bins) {
    sum += bin.mean_raw * static_cast<double>(bin.rows);
    rows += static_cast<double>(bin.rows);
  }
  return sum / rows;
}

TEST(MismatchMaps, ReadEachDirectionFromItsOwnCoordinate) {
  const WhitenedRun run;
  Linearization linear = run.linear();
  for (RowInfo& row : linear.rows)
    if (row.channel == kChannel<Markers>) row.raw = row.component % 2 == 0 ? 1.0 : 0.0;
  int sideways = 0, up_and_down = 0;
  for (const Mismatch& map : mismatchMaps(WhitenedModel(linear, {}), 1)) {
    if (map.direction == "sideways" && ++sideways > 0) EXPECT_NEAR(meanOf(map), 1.0, 1e-12) << map.against;
    if (map.direction == "up and down" && ++up_and_down > 0)
      EXPECT_NEAR(meanOf(map), 0.0, 1e-12) << map.against;
  }
  EXPECT_GT(sideways, 3);
  EXPECT_EQ(sideways, up_and_down);
}

TEST(MismatchMaps, SayWhereWithTheUnitUnlessThereIsNone) {
  const WhitenedRun run;
  bool any = false;
  for (const Mismatch& map : mismatchMaps(WhitenedModel(run.linear(), {}), 1)) {
    if (map.against == "range") EXPECT_TRUE(map.where.ends_with(" m")) << map.where;
    if (map.against != "image radius") continue;
    any = true;
    EXPECT_NE(map.where.find(" to "), std::string::npos);
    EXPECT_FALSE(map.where.ends_with(" 1")) << map.where;
  }
  EXPECT_TRUE(any);
}

// What is read from the reduced system is what a step of all unknowns at once says, budget and all.
TEST(Refit, ItsEffectsAreThoseOfTheWholeLinearModel) {
  const WhitenedRun run;
  const Candidate scale{kEffectIndex<DvlScale>, {}, {}, {}, {}},
      latency{kEffectIndex<CameraLatency>, {}, {}, {}, {}};
  NoiseModel noise;
  noise.budget = fieldBudget().of(CameraPipeline::linear);
  const Refit fit = refit(run.input.data, startingAt(run.estimate), {}, {scale, latency}, noise);
  ASSERT_TRUE(fit.succeeded) << fit.estimate.failure;
  const Nuisances& nuisances = fit.model->nuisances();
  const Eigen::VectorXd step = nuisances.step(fit.model->residual());
  int compared = 0;
  for (const UnknownBlock& block : fit.model->linear().blocks) {
    if (block.kind != UnknownBlock::Kind::effect) continue;
    const std::size_t scalar = continuousScalars(block.index)[0];
    const double sigma = std::sqrt(nuisances.covariance({block.column})(0, 0));
    for (const EffectEstimate& found : fit.estimates) {
      if (found.scalar != scalar) continue;
      ++compared;
      EXPECT_NEAR(found.sigma, sigma, 1e-6 * sigma);
      EXPECT_NEAR(found.value, fit.linearized_at.effects.values[scalar] + step[block.column], 1e-4 * sigma);
    }
  }
  EXPECT_EQ(compared, 2);
}

TEST(SizedEffect, HasItsOwnEffectsValues) {
  const WhitenedRun run;
  const Candidate scale{kEffectIndex<DvlScale>, {}, {}, {}, {}},
      latency{kEffectIndex<CameraLatency>, {}, {}, {}, {}};
  const Refit fit = refit(run.input.data, startingAt(run.estimate), {}, {scale, latency}, {});
  ASSERT_TRUE(fit.succeeded) << fit.estimate.failure;
  for (const Candidate& effect : {scale, latency}) {
    const SizedEffect own = sized(fit, effect);
    std::size_t k = 0;
    for (const EffectEstimate& estimate : fit.estimates)
      if (estimate.effect == effect.effect)
        EXPECT_EQ(own.value[static_cast<Eigen::Index>(k++)], estimate.value) << nameOf(effect);
    EXPECT_EQ(std::ssize(own.value), static_cast<std::ptrdiff_t>(k));
  }
}

}  // namespace
}  // namespace fathom
