#include "diagnosis/fits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "diagnosis/budget_file.h"
#include "diagnosis/confirmation.h"
#include "diagnosis/nominal.h"
#include "effects/catalogue.h"
#include "support/flawed_runs.h"

namespace fathom {
namespace {

constexpr int kSegments = 30;

/// Without a camera: the DVL alone tells.
test::BatchRun navigationRun() {
  test::BatchRun run = test::richRun(1, 24.0);
  run.vehicle.camera.reset();
  return run;
}

class FitsOf {
 public:
  explicit FitsOf(const test::BatchRun& run) : FitsOf(run.input()) {}
  explicit FitsOf(BatchInput input) : input_(std::move(input)), fits_(input_.data, kSegments) {
    NominalFit nominal = nominalFit(input_.data, input_.start, {}, fieldBudget(), 1);
    fits_.beginWith(std::move(nominal.fit), std::move(nominal.options), nominal.noise);
  }

  Refit of(const std::vector<Candidate>& effects) { return fits_.of(fits_.nominal(), effects); }
  Fits* operator->() { return &fits_; }
  const Fits& all() const { return fits_; }

 private:
  BatchInput input_;
  Fits fits_;
};

template <class Effect>
Candidate during(const Interval& active_s) {
  Candidate candidate;
  candidate.effect = kEffectIndex<Effect>;
  candidate.active_s = active_s;
  return candidate;
}

// A place that seemed covered with growth as long as a veil was missing is as all others beside it.
TEST(Fits, JudgeAnewWhoIsApart) {
  const BatchInput input = test::plainNull(test::lightDive(), 1).input();
  const NominalFit nominal = nominalFit(input.data, input.start, {}, fieldBudget(), 1);
  ASSERT_TRUE(nominal.failure.empty()) << nominal.failure;
  NoiseModel noise = nominal.noise;
  noise.apart.resize(noise.budget.components.size());
  for (std::size_t k = 0; k < noise.apart.size(); ++k)
    if (noise.budget.components[k].name == "print-reflectance")
      noise.apart[k][{input.data.patches.front().marker_id, 0}] = 0.5;
  const Refit again = refit(input.data, nominal.fit, nominal.options, {}, noise);
  ASSERT_TRUE(again.succeeded);
  for (const auto& apart : again.noise.apart) EXPECT_TRUE(apart.empty());
  EXPECT_NEAR(again.weight.log_evidence, nominal.fit.weight.log_evidence, 0.1);
}

// A part of a latency of a second, and a DVL that is turned elsewhere, were a minimum of their own in a real
// recording.
TEST(Fits, LetAPartLastWhereThatFitsBetter) {
  test::BatchRun run = navigationRun();
  run.effects.add<DvlLatency>({-0.5});
  FitsOf fits(run);
  const Refit parts = fits.of(
      {during<DvlLatency>({12, Interval::kForever_s}), during<DvlMisalignment>({-Interval::kForever_s, 12})});
  ASSERT_TRUE(parts.succeeded);
  const Refit lasting = fits->lastingWhereBetter(parts);
  EXPECT_EQ(lasting.effects, std::vector<Candidate>{during<DvlLatency>({})});
  EXPECT_NEAR(lasting.estimates.at(0).value, -0.5, 4 * lasting.estimates.at(0).sigma);
  EXPECT_GT(fits->logOdds(lasting), fits->logOdds(parts));
}

TEST(Fits, LeaveAPartThatIsOne) {
  test::BatchRun run = navigationRun();
  const Interval second_half{12, Interval::kForever_s};
  run.effects.add<DvlLatency>({-0.5});
  run.effects.active_s[kEffectIndex<DvlLatency>] = second_half;
  FitsOf fits(run);
  const Refit part = fits.of({during<DvlLatency>(second_half)});
  ASSERT_TRUE(part.succeeded);
  EXPECT_EQ(fits->lastingWhereBetter(part).effects, part.effects);
}

// Of a recording in which a flicker of 0.07 % lay beside gains of 0.2 %: light was linear about a state that
// knew nothing of how it scatters.
TEST(Fits, AreHeldOutWithDrawsThatScatterAsTheyWereFoundTo) {
  test::DiagnosisRun hidden = test::plainNull(test::lightDive(), 1);
  hidden.run.effects.add<SunFlicker>({0.001});
  hidden.change_light = [](std::vector<ImagePatch>& patches) {
    for (ImagePatch& patch : patches)
      patch.radiance *= std::exp(0.02 * Random::stream(5, patch.image).normal());
  };
  FitsOf fits(hidden.input());
  Refit fit = fits.of({during<SunFlicker>({})});
  ASSERT_TRUE(fit.succeeded);
  ASSERT_FALSE(fit.linearized_at.light.empty());
  const std::size_t scatter = allEffects()[kEffectIndex<SunFlicker>].first_scalar;
  ASSERT_GT(fit.estimate.state.effects.values[scatter], 0);
  HeldOutOptions options;
  options.yardsticks = false;
  const HeldOutGain gain = heldOut(fits.all(), fit, options).gain;
  fit.linearized_at.effects.values[scatter] = 1e-6;
  EXPECT_EQ(heldOut(fits.all(), fit, options).gain.by_effect, gain.by_effect);
  EXPECT_GT(gain.by_effect.at(0), 10);
}

}  // namespace
}  // namespace fathom
