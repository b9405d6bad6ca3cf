// How large the proof takes effects to be.
#include <gtest/gtest.h>

#include "effects/drawn.h"
#include "proof/resolution.h"
#include "support/diagnosis_runs.h"

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
  EXPECT_NEAR(nullResolution().sqrtLambda(scaled(scale, 2)), 2 * nullResolution().sqrtLambda(scale), 1e-9);
}

TEST(ProofResolution, AnEffectIsAlignedWithItsLikes) {
  const Hidden scale = hiddenScale(0.01);
  const std::vector<double> alignments = nullResolution().alignments(scale);
  ASSERT_EQ(alignments.size(), nullResolution().rivals().size());
  for (std::size_t i = 0; i < alignments.size(); ++i) {
    EXPECT_GE(alignments[i], 0);
    EXPECT_LE(alignments[i], 1);
    if (nullResolution().rivals()[i].effect == kEffectIndex<DvlScale>) EXPECT_NEAR(alignments[i], 1, 1e-9);
    if (nullResolution().rivals()[i].effect == kEffectIndex<PressureOffset>) EXPECT_LT(alignments[i], 0.3);
  }
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
