// White that grows over black in a rendered image: by so much at every edge.
#include <gtest/gtest.h>

#include <cmath>

#include "imaging/image_model.h"

namespace fathom {
namespace {

/// Light right of an edge through (20.3, 20), turned so far from upright; pixels mix what they show of both.
cv::Mat edge(double angle_rad) {
  cv::Mat light(41, 41, CV_32FC3);
  for (int v = 0; v < light.rows; ++v)
    for (int u = 0; u < light.cols; ++u) {
      constexpr int kParts = 40;
      int bright = 0;
      for (int i = 0; i < kParts * kParts; ++i) {
        const double x = u - 20.3 + (i % kParts + 0.5) / kParts - 0.5,
                     y = v - 20.0 + (i / kParts + 0.5) / kParts - 0.5;
        bright += x * std::cos(angle_rad) + y * std::sin(angle_rad) > 0 ? 1 : 0;
      }
      light.at<cv::Vec3f>(v, u) =
          cv::Vec3f::all(0.1F + 0.6F * static_cast<float>(bright) / (kParts * kParts));
    }
  return light;
}

/// How much light there is in the middle rows, in pixels of the edge's step along a row.
double litWidth_px(const cv::Mat& light) {
  double sum = 0;
  for (int v = 18; v <= 22; ++v)
    for (int u = 0; u < light.cols; ++u) sum += (light.at<cv::Vec3f>(v, u)[1] - 0.1) / 0.6;
  return sum / 5;
}

TEST(WhiteGrown, MovesEdgesAtAnyAngleByAsMuch) {
  for (const double angle_deg : {0.0, 5.0, 20.0, 45.0})
    for (const double by_px : {0.05, -0.05, 0.3, -0.3, 1.0}) {
      const double angle_rad = radians(angle_deg);
      const cv::Mat before = edge(angle_rad), after = whiteGrown(before, by_px);
      const double moved_px = (litWidth_px(after) - litWidth_px(before)) * std::cos(angle_rad);
      EXPECT_NEAR(moved_px, by_px, 0.08 * std::abs(by_px)) << angle_deg;
    }
}

TEST(WhiteGrown, OvershootsNowhere) {
  double least = 0, most = 0;
  for (const double by_px : {1.5, -1.5}) {
    cv::minMaxLoc(whiteGrown(edge(0.3), by_px).reshape(1), &least, &most);
    EXPECT_GE(least, 0.1 - 1e-6);
    EXPECT_LE(most, 0.7 + 1e-6);
  }
}

TEST(WhiteGrown, LeavesPlainLightAlone) {
  const cv::Mat plain(9, 9, CV_32FC3, cv::Scalar::all(0.4));
  EXPECT_EQ(cv::norm(whiteGrown(plain, 0.7), plain, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace fathom
