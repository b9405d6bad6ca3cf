// What is named of what fits.
#include "diagnosis/confirmation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "effects/registry.h"

namespace fathom {
namespace {

Candidate effect(std::size_t index, const Interval& active_s = {}) {
  Candidate candidate;
  candidate.effect = index;
  candidate.active_s = active_s;
  return candidate;
}

TEST(Confirmation, WhatComesAndGoesInCornersMayBeAnErrorOfTheirLight) {
  const Candidate lamp = effect(kEffectIndex<Lamp>);
  EXPECT_TRUE(mayErrAs(lamp, effect(kEffectIndex<CameraMisalignment>, {20, 35})));
  EXPECT_FALSE(mayErrAs(lamp, effect(kEffectIndex<CameraMisalignment>)));
  EXPECT_FALSE(mayErrAs(lamp, effect(kEffectIndex<CameraMisalignment>, {20, Interval::kForever_s})));
  EXPECT_TRUE(mayErrAs(lamp, effect(kEffectIndex<Vignetting>)));
  EXPECT_FALSE(mayErrAs(lamp, effect(kEffectIndex<DvlScale>, {20, 35})));
  EXPECT_FALSE(mayErrAs(effect(kEffectIndex<CameraMisalignment>, {20, 35}), lamp));
}

// By chance the best of all that was tried reaches the threshold in a share of recordings; but one more name
// beside others is held to the 95 % of a stated set, however low that is.
TEST(Confirmation, OneMoreNameHasToBe95PercentSure) {
  const BatchData data;
  Fits fits(data, 30);
  fits.setThreshold(0);
  EXPECT_NEAR(1 / (1 + std::exp(-fits.thresholdBeside())), 0.95, 0.001);
  EXPECT_EQ(fits.threshold(), 0);
  fits.setThreshold(7);
  EXPECT_EQ(fits.thresholdBeside(), 7);
}

}  // namespace
}  // namespace fathom
