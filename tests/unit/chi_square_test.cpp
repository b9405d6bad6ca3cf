#include "core/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fathom {
namespace {

TEST(ChiSquare, QuantilesAreThoseOfTheTables) {
  // Abramowitz & Stegun, table 26.8, to its last digit.
  EXPECT_NEAR(chiSquareQuantile(1, 0.95), 3.84146, 5e-6);
  EXPECT_NEAR(chiSquareQuantile(10, 0.99), 23.2093, 5e-5);
}

TEST(ChiSquare, TailOfTwoDegreesIsExponential) {
  // Q(1, x) = exp(-x), also where that is no double any more.
  for (const double value : {0.1, 5.0, 100.0, 1400.0, 3000.0, 1e6})
    EXPECT_NEAR(chiSquareLogTail(2, value), -0.5 * value, 1e-10 * value) << value;
}

TEST(ChiSquare, TailHasNoStepWhereTheExpansionBegins) {
  for (const double dof : {1.0, 3.0, 7.0, 40.0})
    for (double value = 1200; value < 1500; value += 7) {
      // The slope of ln Q is -1/2 + (dof/2 - 1)/(value/2)/2 or so.
      const double step = chiSquareLogTail(dof, value + 7) - chiSquareLogTail(dof, value);
      EXPECT_LT(step, -3.2) << dof << ' ' << value;
      EXPECT_GT(step, -3.51) << dof << ' ' << value;
    }
}

TEST(ChiSquare, OfAnEstimatedVarianceHasHeavierTails) {
  // Of two degrees of freedom: (1 + x / n)^(-n/2), also where that is no double any more.
  for (const double freedom : {5.0, 72.0, 4000.0})
    for (const double value : {0.1, 5.0, 100.0, 3000.0, 1e6})
      EXPECT_NEAR(chiSquareLogTail(2, value, freedom), -0.5 * freedom * std::log1p(value / freedom),
                  1e-9 * (1 + value))
          << freedom << ' ' << value;
  EXPECT_EQ(chiSquareLogTail(3, 7, std::numeric_limits<double>::infinity()), chiSquareLogTail(3, 7));
}

TEST(ChiSquare, NothingExceedsZeroLess) {
  EXPECT_EQ(chiSquareLogTail(3, 0), 0);
  EXPECT_EQ(chiSquareLogTail(3, -1), 0);
}

}  // namespace
}  // namespace fathom
