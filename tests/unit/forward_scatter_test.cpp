// Light that is bent on its way: how far, and how often.
#include "imaging/forward_scatter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

/// So many times as many pixels for the same view.
CameraModel squareCamera(int finer = 1) {
  CameraModel camera;
  camera.width_px = camera.height_px = 240 * finer;
  camera.fx_px = camera.fy_px = 555 * finer;
  camera.cx_px = camera.cy_px = 120 * finer;
  return camera;
}

/// What of a point's light arrives within so many pixels of it.
double shareWithin(const cv::Mat& light, double radius_px) {
  double inside = 0, all = 0;
  for (int v = 0; v < light.rows; ++v)
    for (int u = 0; u < light.cols; ++u) {
      all += light.at<float>(v, u);
      if (std::hypot(u - 119.5, v - 119.5) < radius_px) inside += light.at<float>(v, u);
    }
  return inside / all;
}

cv::Mat bentPoint(int bends) {
  cv::Mat point = cv::Mat::zeros(240, 240, CV_32FC1);
  point(cv::Rect(119, 119, 2, 2)) = 1;
  return bentLight(point, squareCamera(), bends);
}

/// Within a radius, of light that was bent once at a place of the way that is as likely as any other: the
/// mean over places of a plane normal distribution's share.
double expectedWithin(double radius_px) {
  constexpr int kSteps = 10000;
  double sum = 0;
  for (int step = 0; step < kSteps; ++step) {
    const double sigma_px = 555 * kBend_rad * (step + 0.5) / kSteps;
    sum += -std::expm1(-0.5 * std::pow(radius_px / sigma_px, 2)) / kSteps;
  }
  return sum;
}

// To what six places of the way and half as many pixels can do.
TEST(ForwardScatter, OfLightBentOnceAThirdStaysNear) {
  const cv::Mat once = bentPoint(1);
  for (const double radius_px : {6.0, 10.0, 20.0, 40.0})
    EXPECT_NEAR(shareWithin(once, radius_px), expectedWithin(radius_px), 0.03) << radius_px;
}

TEST(ForwardScatter, LightBentSeveralTimesIsNormal) {
  for (const int bends : {2, 4})
    for (const double radius_px : {10.0, 20.0, 40.0}) {
      const double variance_px2 = bends * std::pow(555 * kBend_rad, 2) / 3;
      EXPECT_NEAR(shareWithin(bentPoint(bends), radius_px),
                  -std::expm1(-0.5 * radius_px * radius_px / variance_px2), 0.02)
          << bends << " " << radius_px;
    }
}

// Six times as many pixels a radian: wide kernels are applied to smaller images. The same places, to the
// pixel's own size: a point of one pixel is a square of six.
TEST(ForwardScatter, IsOfAnglesWhateverThePixelsAre) {
  constexpr int kFiner = 6;
  cv::Mat coarse = cv::Mat::zeros(240, 240, CV_32FC1), fine;
  coarse(cv::Rect(80, 100, 40, 30)) = 1;
  cv::resize(coarse, fine, {}, kFiner, kFiner, cv::INTER_NEAREST);
  for (const int bends : {1, 2, 4}) {
    cv::Mat seen;
    cv::resize(bentLight(fine, squareCamera(kFiner), bends), seen, coarse.size(), 0, 0, cv::INTER_AREA);
    EXPECT_LT(cv::norm(seen, bentLight(coarse, squareCamera(), bends), cv::NORM_INF), 0.02) << bends;
  }
}

// Were each surrounding as bright as it has bends: the mean number of what is bent at all.
TEST(ForwardScatter, BendsAreAsManyAsPoissonsLawHas) {
  const Surroundings<double> bright = Vector3d::Ones() * Eigen::RowVector3d(1, 2, 4);
  const SceneRadiance<double> scene(Vector3d::Zero(), bright);
  for (const double n : {1e-9, 0.1, 0.5, 1.0, 2.0})
    EXPECT_NEAR(scene.bent(0, n), n / -std::expm1(-n), 0.01 * n / -std::expm1(-n)) << n;
}

}  // namespace
}  // namespace fathom
