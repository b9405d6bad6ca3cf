// How large the proof takes effects to be.
#include <gtest/gtest.h>

#include "effects/drawn.h"
#include "proof/resolution.h"
#include "support/flawed_runs.h"

namespace fathom::proof {
namespace {

/// A dive that hides nothing, as recorded.
const test::BatchRun& nullDive() {
  static const test::BatchRun run = test::richRun(1, 40.0);
  return run;
}
const Resolution& nullResolution() {
  static const Resolution resolution(nullDive().input());
  return resolution;
}

Hidden hiddenScale(double scale_error) {
  Hidden hidden;
  hidden.candidate.effect = kEffectIndex<DvlScale>;
  hidden.effects.add<DvlScale>({scale_error});
  return hidden;
}

// Independently: simulated without noise, all orders, in units of the noise stated. The noise shown is that
// to some percent, as it is estimated from a recording.
TEST(ProofResolution, SizesAreThoseOfTheSignal) {
  const test::Excitation excitation(nullDive());
  const Hidden scale = hiddenScale(0.01);
  const double expected = excitation.sqrtLambda(scale.effects);
  EXPECT_NEAR(nullResolution().sqrtLambda(scale), expected, 0.1 * expected);
  EXPECT_NEAR(nullResolution().sqrtLambda(hiddenScale(0.02)), 2 * nullResolution().sqrtLambda(scale), 1e-9);
}

/// |c| of the rival that is most like what is hidden, of one effect.
double alignmentWith(std::size_t effect, const Hidden& hidden) {
  double largest = 0;
  for (const Rival& rival : nullResolution().rivalsOf(hidden)) {
    EXPECT_NE(rival.candidate.effect, hidden.candidate.effect);
    EXPECT_GE(rival.alignment, 0);
    EXPECT_LE(rival.alignment, 1);
    if (rival.candidate.effect == effect) largest = std::max(largest, rival.alignment);
  }
  return largest;
}

// A bias is constant in the robot's axes, the Earth's rotation in the world's: alike where it turns little.
TEST(ProofResolution, AnEffectIsAlignedWithItsLikes) {
  Hidden bias;
  bias.candidate.effect = kEffectIndex<GyroBias>;
  bias.effects.add<GyroBias>({1e-3, 0, 0});
  EXPECT_GT(alignmentWith(kEffectIndex<EarthRotation>, bias), 0.5);
  EXPECT_LT(alignmentWith(kEffectIndex<PressureOffset>, bias), 0.3);
}

// What is on for a part of the recording has rivals that last and such as are on for that part. The more of
// it is needed the larger a rival would have to be.
TEST(ProofResolution, AnEffectOfAPartHasRivalsOfThatPart) {
  const Hidden part = test::activeDuring(hiddenScale(0.01), {10, 25});
  const std::vector<Rival> rivals = nullResolution().rivalsOf(part),
                           of_double =
                               nullResolution().rivalsOf({part.candidate, test::scaled(part.effects, 2)});
  int of_the_part = 0;
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    if (rivals[i].candidate.active_s == part.candidate.active_s) ++of_the_part;
    EXPECT_NEAR(of_double[i].alignment, rivals[i].alignment, 1e-9);
    EXPECT_NEAR(of_double[i].prior_sigmas, 2 * rivals[i].prior_sigmas, 1e-6 * rivals[i].prior_sigmas);
  }
  EXPECT_GT(of_the_part, 10);
  EXPECT_LT(nullResolution().sqrtLambda(part), nullResolution().sqrtLambda(hiddenScale(0.01)));
}

// What a recording without noise shows: of an effect of the catalogue its size, of which that effect leaves
// next to nothing; of a DVL that is quadratic, more than any effect imitates.
TEST(ProofResolution, WhatIsOutsideTheCatalogueIsLeft) {
  test::BatchRun quiet = nullDive();
  quiet.noise = false;
  quiet.effects = hiddenScale(0.02).effects;
  const Resolution::Shown scale = nullResolution().shownBy(quiet.input());
  const double size = nullResolution().sqrtLambda(hiddenScale(0.02));
  EXPECT_NEAR(std::sqrt(scale.lambda), size, 0.1 * size);
  EXPECT_LT(scale.left, 0.05 * scale.lambda);

  quiet.effects = {};
  std::vector<Sample> samples = quiet.samples();
  test::makeDvlQuadratic(samples, 0.4);
  const Resolution::Shown quadratic = nullResolution().shownBy(quiet.input(samples));
  EXPECT_GT(quadratic.left, 30);
  EXPECT_LT(quadratic.left, quadratic.lambda);
}

}  // namespace
}  // namespace fathom::proof
