// What handles look like, where they can be, and how their angles add up.
#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/imgproc.hpp>

#include "handles/circular_average.h"
#include "handles/superellipse.h"
#include "handles/swept_box.h"

namespace fathom {
namespace {

Handle lever() {
  Handle handle;
  handle.radius_m = 0.045;
  handle.length_m = 0.11;
  handle.largest_angle_rad = radians(90);
  return handle;
}

TEST(SweptBox, HoldsTheHandleAtEveryAngle) {
  for (const HandleKind kind : {HandleKind::lever, HandleKind::valve, HandleKind::wheel}) {
    Handle handle = lever();
    handle.kind = kind;
    const SweptBox box = sweptBoxOf(handle);
    double farthest = 0;
    for (int deg = 0; deg < 360; deg += 7) {
      handle.angle_rad = radians(deg);
      for (const auto& vertex : surfaceOf(handle).vertices) {
        const Vector3d foot =
            rotationFromYawPitchRoll(handle.angle_rad, 0, 0) * vertex.position.cast<double>();
        EXPECT_LE(foot.cwiseAbs().head<2>().maxCoeff(), box.reach_m + 1e-9);
        EXPECT_LE(foot.z(), box.top_m + 1e-9);
        farthest = std::max(farthest, foot.head<2>().norm());
      }
    }
    EXPECT_NEAR(farthest, box.reach_m, 1e-6);  // and no more
    EXPECT_GE(edgeHeight_m(handle), 0.5 * box.top_m);
    EXPECT_LE(edgeHeight_m(handle), box.top_m + 1e-6);
  }
}

// A bar of 0.11 x 0.0242 m on a hub of radius 0.027 m, of which 0.6 or so is beside the bar.
TEST(SweptBox, SilhouetteOfALever) {
  const double bar = 0.11 * 0.0242, hub = std::numbers::pi * 0.027 * 0.027;
  EXPECT_GT(silhouette_m2(lever()), bar);
  EXPECT_LT(silhouette_m2(lever()), bar + hub);
}

TEST(HandleAngles, DifferBySymmetry) {
  EXPECT_NEAR(degrees(angleDifference(radians(179), radians(-2), std::numbers::pi)), 1, 1e-9);
  EXPECT_NEAR(degrees(angleDifference(radians(10), radians(350), 2 * std::numbers::pi)), 20, 1e-9);
  Handle valve = lever();
  valve.kind = HandleKind::valve;
  valve.smallest_angle_rad = radians(-45);
  valve.largest_angle_rad = radians(45);
  const auto angles = anglesInRange(valve, radians(170), symmetryOf(valve.kind));
  ASSERT_EQ(angles.size(), 1U);
  EXPECT_NEAR(degrees(angles[0]), -10, 1e-9);
  EXPECT_TRUE(anglesInRange(valve, radians(90), symmetryOf(valve.kind)).empty());
  EXPECT_EQ(anglesInRange(valve, radians(47), symmetryOf(valve.kind), radians(5)).size(), 1U);
}

TEST(Superellipse, IsFoundInWhatItDraws) {
  for (const double exponent : {1.5, 2.0, 4.0, 8.0})
    for (const double turn_deg : {0.0, 20.0, 70.0}) {
      const Superellipse truth{{41.3, 38.7}, {25, 10}, radians(turn_deg), exponent};
      const cv::Mat mask = truth.drawn({80, 80}) > 0.5;
      const Superellipse found = superellipseOf(mask);
      // Every second pixel of it is looked at.
      EXPECT_LT((found.centre_px - truth.centre_px).norm(), 0.7);
      EXPECT_LT((found.half_axes_px - truth.half_axes_px).cwiseAbs().maxCoeff(), 0.7);
      EXPECT_LT(std::abs(degrees(angleDifference(found.turn_rad, truth.turn_rad, std::numbers::pi))), 1.5);
      // A mask of whole pixels hardly tells one large exponent from another.
      EXPECT_NEAR(1 / found.exponent, 1 / truth.exponent, 0.06) << exponent << " " << turn_deg;
    }
}

TEST(CircularAverage, AcrossTheSeam) {
  CircularAverage average(std::numbers::pi, 10);
  for (const double deg : {178.0, 1.0, -1.0, 2.0}) average.add(radians(deg), radians(1));
  EXPECT_NEAR(std::abs(degrees(angleDifference(average.mean_rad(), 0, std::numbers::pi))), 0, 0.01);
  EXPECT_GT(average.agreement(), 0.99);
}

TEST(CircularAverage, ForgetsWhatIsOld) {
  CircularAverage average(2 * std::numbers::pi, 3);
  for (const double deg : {200.0, 10.0, 11.0, 12.0}) average.add(radians(deg), radians(1));
  EXPECT_NEAR(degrees(average.mean_rad()), 11, 1e-6);
  EXPECT_EQ(average.count(), 3U);
}

// Three readings of sigma 1 that scatter by 10: the scatter counts.
TEST(CircularAverage, SigmaOfWhatScattersMore) {
  CircularAverage calm(2 * std::numbers::pi, 3), wild(2 * std::numbers::pi, 3);
  for (const double deg : {-10.0, 0.0, 10.0}) {
    calm.add(radians(0.1 * deg), radians(1));
    wild.add(radians(deg), radians(1));
  }
  EXPECT_NEAR(degrees(calm.sigma_rad()), 1 / std::sqrt(3.0), 0.01);
  EXPECT_NEAR(degrees(wild.sigma_rad()), std::sqrt(200.0 / 3 / 2), 0.01);
}

}  // namespace
}  // namespace fathom
