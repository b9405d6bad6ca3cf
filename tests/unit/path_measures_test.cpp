#include "localization/path_measures.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace fathom {
namespace {

const Time kDawn = fromUnixSeconds(1'700'000'000);

std::vector<Time> everySecond(int count) {
  std::vector<Time> times;
  for (int i = 0; i < count; ++i) times.push_back(after(kDawn, i));
  return times;
}

/// A path sampled at the times, by its pose at t seconds.
template <class F>
std::vector<StampedPose> pathOf(const std::vector<Time>& times, F&& pose) {
  std::vector<StampedPose> path;
  for (const Time& time : times) path.push_back({time, pose(secondsBetween(kDawn, time))});
  return path;
}

Pose swaying(double t_s, double period_s) {
  const double phase = 2 * M_PI * t_s / period_s;
  const Vector3d wave(std::sin(phase), std::sin(phase + 1), std::sin(phase + 2));
  return {expSO3<double>(0.1 * wave), wave};
}

TEST(PathMeasures, ErrorsAreDistancesAtTheReferencesTimes) {
  const auto times = everySecond(5);
  const auto reference = pathOf(times, [](double) { return Pose{}; });
  const auto path = pathOf(times, [](double t) {
    return Pose{expSO3<double>(Vector3d(0, 0, 0.1)), Vector3d(3, 4, 0) * (t < 2 ? 1 : 2)};
  });
  const auto errors = errorsAgainst(reference, path);
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->count, 5U);
  EXPECT_NEAR(errors->position_m.mean, (2 * 5 + 3 * 10) / 5.0, 1e-12);
  EXPECT_NEAR(errors->position_m.sigma, std::sqrt((2 * 9 + 3 * 4) / 4.0), 1e-12);
  EXPECT_NEAR(errors->angle_rad.mean, 0.1, 1e-12);
}

TEST(PathMeasures, ReferenceOutsideThePathDoesNotCount) {
  const auto path = pathOf(everySecond(3), [](double) { return Pose{}; });
  const auto later = pathOf({after(kDawn, 1.5), after(kDawn, 10)}, [](double) { return Pose{}; });
  EXPECT_EQ(errorsAgainst(later, path)->count, 1U);
  EXPECT_FALSE(errorsAgainst({{after(kDawn, 10), Pose{}}}, path));
}

// Increments of a sine of period T are a sine: their lag-one autocorrelation over whole periods is cos(2 pi /
// T).
TEST(PathMeasures, SmoothnessOfASwayIsTheCosineOfItsStep) {
  for (const double period_s : {5.0, 20.0, 100.0}) {
    const auto times = everySecond(2001);
    const auto smoothness =
        smoothnessOf(pathOf(times, [&](double t) { return swaying(t, period_s); }), times);
    ASSERT_TRUE(smoothness);
    // The rotation's increments are not quite a sine (0.1 rad wide), and the ends of 2000 s count a little.
    EXPECT_NEAR(smoothness->increments_r, std::cos(2 * M_PI / period_s), 5e-3) << period_s;
  }
}

// White noise on a standing robot: increments n(k+1) - n(k) have lag-one autocorrelation -1/2.
TEST(PathMeasures, JitterIsRough) {
  Random random(1);
  const auto times = everySecond(20000);
  const auto path = pathOf(times, [&](double) { return Pose{Matrix3d::Identity(), random.normal3()}; });
  EXPECT_NEAR(smoothnessOf(path, times)->increments_r, -0.5, 0.02);  // 3 / sqrt(3 * 20000) is 0.012
}

TEST(PathMeasures, MeanProductIsThePapersSum) {
  const auto times = everySecond(11);
  const auto path = pathOf(times, [](double t) { return Pose{Matrix3d::Identity(), Vector3d(t, 1, 0)}; });
  EXPECT_FALSE(smoothnessOf(path, times)) << "steady motion has no increments that vary";
  const auto uneven = pathOf(times, [](double t) {
    return Pose{Matrix3d::Identity(), Vector3d(t * t, 1, 0)};
  });
  double sum = 0;
  for (int t = 1; t <= 10; ++t) sum += t * t * (t - 1) * (t - 1) + 1;
  EXPECT_NEAR(smoothnessOf(uneven, times)->mean_product_m2, sum / 10, 1e-9);
}

TEST(PathMeasures, TimesOutsideThePathAreLeftOut) {
  const auto times = everySecond(200);
  const auto path = pathOf(times, [](double t) { return swaying(t, 40); });
  std::vector<Time> more{after(kDawn, -5)};
  more.insert(more.end(), times.begin(), times.end());
  more.push_back(after(kDawn, 500));
  EXPECT_EQ(smoothnessOf(path, more)->increments_r, smoothnessOf(path, times)->increments_r);
  EXPECT_FALSE(smoothnessOf(path, {after(kDawn, -5), after(kDawn, 500)}));
}

}  // namespace
}  // namespace fathom
