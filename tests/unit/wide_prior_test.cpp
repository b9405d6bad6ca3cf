#include "estimation/wide_prior.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom {
namespace {

TEST(WidePrior, IsNormalAsFarAsItsDimensionsReach) {
  for (const double n : {1.0, 3.0, 6.0})
    for (const double square : {0.0, 0.3 * n, n}) {
      EXPECT_EQ(widePriorCost(square, n), 0.5 * square);
      EXPECT_EQ(widePriorWeight(square, n), 1);
    }
}

/// The weight is the cost's derivative by half the square, and neither jumps where the tail begins.
TEST(WidePrior, WeightAndCurvatureAreTheCostsDerivatives) {
  for (const double n : {1.0, 3.0})
    for (const double square : {0.5 * n, 1.0001 * n, 3.0 * n, 400.0 * n}) {
      const double step = 1e-5 * square;
      const WidePriorLoss loss(n);
      double rho[3], before[3], behind[3];
      loss.Evaluate(square, rho);
      loss.Evaluate(square - step, before);
      loss.Evaluate(square + step, behind);
      EXPECT_EQ(rho[0], 2 * widePriorCost(square, n));
      if (std::abs(square - n) < 2 * step) continue;
      EXPECT_NEAR(rho[1], (behind[0] - before[0]) / (2 * step), 1e-6);
      EXPECT_NEAR(rho[2], (behind[1] - before[1]) / (2 * step), 1e-6 / square);
    }
  EXPECT_NEAR(widePriorCost(3 * (1 + 1e-12), 3), 1.5, 1e-11);
  EXPECT_NEAR(widePriorWeight(3 * (1 + 1e-12), 3), 1, 1e-11);
}

/// Of what a reading says of a size of 20 prior sigmas, with a sigma as large as the prior's, a normal prior
/// would leave half.
TEST(WidePrior, LeavesWhatIsMuchLargerThanExpected) {
  double x = 20;
  for (int round = 0; round < 50; ++round) x = 20 / (1 + widePriorWeight(x * x, 1));
  EXPECT_NEAR(x, 20, 2.0 / 20 * 1.1);  // pulled by 2 x / (1 + x^2)
}

}  // namespace
}  // namespace fathom
