// How much softer a marker's edges are than rendered: of patterns that are blurred where pixels are eight
// times as fine, then seen with noise, other light, and a little off.
#include "observables/edge_blur.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/random.h"

namespace fathom {
namespace {

constexpr int kFine = 8, kSize = 64;

/// Black and white cells, turned by 20 degrees, of about 7 px.
cv::Mat finePattern(double shift_x_px, double shift_y_px) {
  cv::Mat fine(kFine * kSize, kFine * kSize, CV_64FC1);
  for (int v = 0; v < fine.rows; ++v)
    for (int u = 0; u < fine.cols; ++u) {
      const double x = (u + 0.5) / kFine - shift_x_px, y = (v + 0.5) / kFine - shift_y_px;
      const double a = (0.94 * x + 0.342 * y) / 7, b = (-0.342 * x + 0.94 * y) / 7;
      const int i = static_cast<int>(std::floor(a)), j = static_cast<int>(std::floor(b));
      fine.at<double>(v, u) = (7 * i * i + 3 * i * j + 5 * j * j + i) % 3 == 0 ? 0.04 : 0.85;
    }
  return fine;
}

cv::Mat pixels(const cv::Mat& fine) {
  cv::Mat image;
  cv::resize(fine, image, {kSize, kSize}, 0, 0, cv::INTER_AREA);
  image.convertTo(image, CV_32F);
  return image;
}

cv::Mat farAround(const cv::Mat& image) {
  cv::Mat soft;
  cv::GaussianBlur(image, soft, {}, 10);
  return soft;
}

/// Three quarters of the light, a fifth of which is scattered, on a veil, both a little more to the right.
cv::Mat underWater(const cv::Mat& image, double noise, Random& random) {
  cv::Mat seen = 0.8 * image + 0.2 * farAround(image);
  for (int v = 0; v < seen.rows; ++v)
    for (int u = 0; u < seen.cols; ++u) {
      const double across = static_cast<double>(u) / seen.cols - 0.5;
      float& value = seen.at<float>(v, u);
      value =
          static_cast<float>((0.75 + 0.05 * across) * value + 0.06 + 0.01 * across + noise * random.normal());
    }
  return seen;
}

struct Case {
  const char* name;
  Vector3d variance_px2;  ///< xx, xy, yy
  bool along_a_line;      ///< as motion blurs
};

/// A blur of that covariance, of fine pixels.
cv::Mat blurredBy(const cv::Mat& fine, const Case& blur) {
  constexpr int kReach = 4 * kFine;
  cv::Mat weights = cv::Mat::zeros(2 * kReach + 1, 2 * kReach + 1, CV_64FC1);
  const auto& [xx, xy, yy] = std::tuple(blur.variance_px2[0], blur.variance_px2[1], blur.variance_px2[2]);
  const double determinant = xx * yy - xy * xy;
  if (blur.along_a_line) {
    for (int k = -500; k <= 500; ++k) {
      const double t = k / 500.0 * std::sqrt(3.0) * kFine;
      const double sign = xy < 0 ? -1 : 1;
      weights.at<double>(kReach + static_cast<int>(std::lround(sign * t * std::sqrt(yy))),
                         kReach + static_cast<int>(std::lround(t * std::sqrt(xx)))) += 1;
    }
  } else {
    for (int v = -kReach; v <= kReach; ++v)
      for (int u = -kReach; u <= kReach; ++u) {
        const double x = static_cast<double>(u) / kFine, y = static_cast<double>(v) / kFine;
        weights.at<double>(v + kReach, u + kReach) =
            std::exp(-0.5 * (yy * x * x - 2 * xy * x * y + xx * y * y) / determinant);
      }
  }
  cv::Mat result;
  cv::filter2D(fine, result, CV_64F, weights / cv::sum(weights)[0], {-1, -1}, 0, cv::BORDER_REPLICATE);
  return result;
}

class EdgeBlurOf : public testing::TestWithParam<Case> {};

// Within four of its own sigmas, and 5 % for what is not quite a normal blur.
TEST_P(EdgeBlurOf, IsFound) {
  const Case& blur = GetParam();
  const Vector2d shift_px(0.2, -0.15);
  const cv::Mat rendered = pixels(finePattern(0, 0));
  const bool sharp = blur.variance_px2.isZero();
  const cv::Mat fine = finePattern(shift_px.x(), shift_px.y());
  const cv::Mat image = pixels(sharp ? fine : blurredBy(fine, blur));
  const cv::Mat mask(kSize, kSize, CV_8UC1, cv::Scalar(255)), around = farAround(rendered);
  Vector3d squares = Vector3d::Zero(), mean = Vector3d::Zero();
  Matrix3d stated = Matrix3d::Zero();
  constexpr int kDraws = 40;
  constexpr double kNoise = 0.01;
  for (int draw = 0; draw < kDraws; ++draw) {
    Random random = Random::stream(5, static_cast<std::uint64_t>(draw));
    const auto found = edgeBlur({underWater(image, kNoise, random), rendered, around, mask, kNoise});
    ASSERT_TRUE(found);
    const Vector3d error = found->variance_px2 - blur.variance_px2;
    mean += error / kDraws;
    squares += error.cwiseAbs2() / kDraws;
    stated += found->covariance_px4 / kDraws;
    EXPECT_LT((found->shift_px - shift_px).norm(), 0.03);
  }
  const Vector3d sigma = stated.diagonal().cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(mean[i], 0, 4 * sigma[i] / std::sqrt(kDraws) + 0.05 * blur.variance_px2.norm() + 0.005) << i;
    const double scatter = std::sqrt(squares[i] - mean[i] * mean[i]);
    EXPECT_NEAR(scatter / sigma[i], 1, 0.4) << i;
  }
  EXPECT_LT(sigma.maxCoeff(), 0.05);
}
INSTANTIATE_TEST_SUITE_P(EdgeBlur, EdgeBlurOf,
                         testing::Values(Case{"none", Vector3d(0, 0, 0), false},
                                         Case{"round", Vector3d(0.5, 0, 0.5), false},
                                         Case{"wide", Vector3d(2, 0.5, 1.5), false},
                                         Case{"along_x", Vector3d(0.6, 0, 0), true},
                                         Case{"aslant", Vector3d(0.5, -0.5, 0.5), true}),
                         [](const auto& info) { return std::string(info.param.name); });

/// What predictBlur() says of a marker that a camera passes so fast that it moves by so many pixels while the
/// shutter is open.
Vector3d predictedAlong(const Vector2d& way_px) {
  MarkerBlur marker;
  marker.camera = {640, 480, 500, 500, 320, 240, 0, 0, 0, 0, 0};
  marker.exposure_s = 0.02;
  marker.point_panel = {0, 0, 2};
  KinematicState<double> state;
  const Vector2d velocity_m_s = -way_px / marker.exposure_s * marker.point_panel.z() / marker.camera.fx_px;
  state.velocity_robot = {velocity_m_s.x(), velocity_m_s.y(), 0};
  return predictBlur<double>(state, {}, marker, 0, {}, 0);
}

// The model's constants are what the comparison of edges makes of a mean over the way, to 6 %.
TEST(EdgeBlur, OfAMeanOverTheWayIsThePredictedOne) {
  const cv::Mat fine = finePattern(0, 0), rendered = pixels(fine), around = farAround(rendered);
  const cv::Mat mask(kSize, kSize, CV_8UC1, cv::Scalar(255));
  Random random(6);
  for (const double way_px : {1.0, 2.0, 4.0, 6.0, 8.0})
    for (const double angle : {0.0, 0.7, 2.0}) {
      const Vector2d way = way_px * Vector2d(std::cos(angle), std::sin(angle));
      const Vector3d variance(way.x() * way.x() / 12, way.x() * way.y() / 12, way.y() * way.y() / 12);
      const cv::Mat seen = underWater(pixels(blurredBy(fine, {"", variance, true})), 0.0, random);
      const auto found = edgeBlur({seen, rendered, around, mask, 0.01});
      ASSERT_TRUE(found);
      const Vector3d predicted = predictedAlong(way);
      EXPECT_LT((found->variance_px2 - predicted).norm(), 0.06 * predicted.norm() + 0.005)
          << way_px << " px: " << found->variance_px2.transpose() << " for " << predicted.transpose();
    }
}

TEST(EdgeBlur, WhereThereAreNoEdgesThereIsNoBlurToFind) {
  const cv::Mat plain(kSize, kSize, CV_32FC1, cv::Scalar(0.5));
  const cv::Mat mask(kSize, kSize, CV_8UC1, cv::Scalar(255)), nothing = cv::Mat::zeros(kSize, kSize, CV_8UC1);
  EXPECT_FALSE(edgeBlur({plain, plain, plain, mask, 0.01}));
  const cv::Mat pattern = pixels(finePattern(0, 0));
  EXPECT_FALSE(edgeBlur({pattern, pattern, farAround(pattern), nothing, 0.01}));
}

}  // namespace
}  // namespace fathom
