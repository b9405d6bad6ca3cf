#include "core/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom {
namespace {

// First values, so that another compiler or library that draws others is noticed. The integers follow from
// the standard (mt19937_64, seed_seq); the 10000th of seed 5489 is the standard's own check value.
TEST(Random, FirstValuesArePinned) {
  Random standard(5489);
  for (int i = 1; i < 10000; ++i) standard.bits();
  EXPECT_EQ(standard.bits(), 9981545732273789042ULL);
  EXPECT_EQ(Random(1).bits(), 2469588189546311528ULL);
  EXPECT_EQ(Random::stream(1, 0).bits(), 1956211474876670270ULL);
  Random random(1);
  EXPECT_EQ(random.uniform(), 0x1.0p-53 * static_cast<double>(2469588189546311528ULL >> 11));
  Random normal(1);
  // Libraries may differ in the last bits of sine and logarithm.
  EXPECT_NEAR(normal.normal(), 0.35099249780849107, 1e-14);
  EXPECT_NEAR(normal.normal(), 0.40529019332161598, 1e-14);
}

// Each tolerance is 4.5 standard errors of the statistic over n draws.
TEST(Random, Moments) {
  constexpr int n = 1'000'000;
  Random random(7);
  double u1 = 0, u2 = 0, m1 = 0, m2 = 0, m3 = 0, m4 = 0, low = 1, high = 0;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform(), x = random.normal();
    low = std::min(low, u), high = std::max(high, u);
    u1 += u / n, u2 += u * u / n;
    m1 += x / n, m2 += x * x / n, m3 += x * x * x / n, m4 += x * x * x * x / n;
  }
  const double error = 4.5 / std::sqrt(n);
  EXPECT_GE(low, 0.0);
  EXPECT_LT(high, 1.0);
  EXPECT_NEAR(u1, 0.5, error * std::sqrt(1.0 / 12));
  EXPECT_NEAR(u2, 1.0 / 3, error * std::sqrt(1.0 / 5 - 1.0 / 9));
  EXPECT_NEAR(m1, 0, error);
  EXPECT_NEAR(m2, 1, error * std::sqrt(2));
  EXPECT_NEAR(m3, 0, error * std::sqrt(15));
  EXPECT_NEAR(m4, 3, error * std::sqrt(96));
}

TEST(Random, TailsAreNormal) {
  constexpr int n = 1'000'000;
  Random random(8);
  int beyond[4] = {};
  for (int i = 0; i < n; ++i)
    for (int k = 1; k < 4; ++k) beyond[k] += std::abs(random.normal()) > k;
  for (int k = 1; k < 4; ++k) {
    const double p = std::erfc(k / std::sqrt(2.0));
    EXPECT_NEAR(beyond[k], n * p, 4.5 * std::sqrt(n * p)) << k;
  }
}

TEST(Random, UniformInARange) {
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-2, 5);
    EXPECT_GE(x, -2);
    EXPECT_LT(x, 5);
  }
}

TEST(Random, StreamsRepeatAndAreUncorrelated) {
  constexpr int n = 100'000;
  for (const auto& [a, b] : {std::pair{Random::stream(1, 0), Random::stream(1, 1)},
                             std::pair{Random::stream(1, 0), Random::stream(2, 0)},
                             std::pair{Random::stream(1, 0), Random::stream(1ULL << 32, 0)},
                             std::pair{Random::stream(1, 2), Random::stream(2, 1)}}) {
    Random first = a, second = b;
    double correlation = 0;
    for (int i = 0; i < n; ++i) correlation += first.normal() * second.normal() / n;
    EXPECT_NEAR(correlation, 0, 4.5 / std::sqrt(n));
  }
  Random once = Random::stream(3, 4), again = Random::stream(3, 4);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(once.bits(), again.bits());
}

TEST(Random, Normal3DrawsInOrder) {
  Random together(5), single(5);
  const Eigen::Vector3d v = together.normal3();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(v[i], single.normal());
}

}  // namespace
}  // namespace fathom
