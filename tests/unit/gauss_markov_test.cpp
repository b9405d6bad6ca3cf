#include "core/gauss_markov.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

constexpr double kTau_s = 120.0;

TEST(GaussMarkov, StaysInItsStationaryDistributionFromTheStartOn) {
  double variance = 0.0;
  GaussMarkovStep step;
  for (const double dt_s : {0.01, 0.5, 30.0, 1000.0}) {
    variance = step.decay * step.decay * variance + step.innovation() * step.innovation();
    EXPECT_NEAR(variance, 1.0, 1e-12);
    step = {dt_s, kTau_s};
  }
}

TEST(GaussMarkov, TwoStepsAreOneOfBothIntervals) {
  const GaussMarkovStep first(3.0, kTau_s), second(20.0, kTau_s), both(23.0, kTau_s);
  EXPECT_NEAR(first.decay * second.decay, both.decay, 1e-15);
  EXPECT_NEAR(std::hypot(second.decay * first.innovation(), second.innovation()), both.innovation(), 1e-15);
}

// The filter adds half of the density's share before and half behind each step: to (dt/tau)²/3, relative.
TEST(GaussMarkov, TheDensityIntegratedByTheTrapezoidalRuleIsTheInnovation) {
  for (const double dt_s : {0.001, 0.05}) {
    const GaussMarkovStep step(dt_s, kTau_s);
    const double half = 0.5 * dt_s * gaussMarkovDensity(kTau_s);
    const double exact = step.innovation() * step.innovation();
    EXPECT_NEAR(half * (1.0 + step.decay * step.decay) / exact, 1.0, dt_s * dt_s / (kTau_s * kTau_s) + 1e-10);
  }
}

}  // namespace
}  // namespace fathom
