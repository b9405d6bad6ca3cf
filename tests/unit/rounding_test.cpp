// Means of rounded numbers, against numbers drawn and rounded.
#include "observables/rounding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace fathom {
namespace {

// A trial errs as it states; all together by half of what rounding does at most, or by chance.
TEST(Rounding, IsUndone) {
  constexpr int kTrials = 200, kCount = 400;
  Random random(1);
  for (const double scatter : {0.15, 0.2, 0.25, 0.3, 0.5, 0.9})
    for (const double x : {5.0, 5.1, 5.3, 5.5, 5.85}) {
      double error = 0, square = 0, plain = 0, stated = 0;
      for (int trial = 0; trial < kTrials; ++trial) {
        double sum = 0, sum_of_squares = 0;
        for (int i = 0; i < kCount; ++i) {
          const double number = std::round(x + scatter * random.normal());
          sum += number;
          sum_of_squares += number * number;
        }
        const double mean = sum / kCount;
        const BeforeRounding before = beforeRounding(
            mean, (sum_of_squares - kCount * mean * mean) / (kCount - 1), kCount, 1.05 * scatter);
        error += (before.mean - x) / kTrials;
        square += std::pow((before.mean - x) / before.sigma, 2) / kTrials;
        plain += (mean - x) / kTrials;
        stated += before.sigma / kTrials;
      }
      EXPECT_LT(std::abs(error), std::max(0.5 * std::abs(plain), 4 * stated / std::sqrt(kTrials)))
          << scatter << " " << x;
      EXPECT_LT(square, 1.3) << scatter << " " << x;
    }
}

TEST(Rounding, LeavesNumbersAllAlikeInDoubt) {
  const BeforeRounding before = beforeRounding(7, 0, 400, 0);
  EXPECT_NEAR(before.mean, 7, 0.01);
  EXPECT_NEAR(before.sigma, 0.2887, 1e-6);
}

}  // namespace
}  // namespace fathom
