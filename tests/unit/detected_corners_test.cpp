// Where edges between black and white seem to be, in images whose numbers are a power of the light.
#include "imaging/detected_corners.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

// Against the sum over pixels on the edge, each with its share of white.
TEST(DetectedCorners, WhiteSpreadsAsPixelsOnTheEdgeSay) {
  constexpr int kPixels = 20000, kGreen = 1;
  for (const double exponent : {0.45, 0.9, 1.0, 1.3})
    for (const double bend : {-0.3, 0.0, 0.2})
      for (const double ratio : {0.01, 0.1, 0.5}) {
        const double bright = 0.7, dark = ratio * bright;
        const ResponseCurve<double> curve{exponent, Vector3d(0.5, bend, -0.5)};
        const auto seen = [&](double light) { return predictReading<double>(light, {}, curve, kGreen); };
        double sum = 0;
        for (int i = 0; i < kPixels; ++i) {
          const double light = dark + (bright - dark) * (i + 0.5) / kPixels;
          sum += (seen(light) - seen(dark)) / (seen(bright) - seen(dark));
        }
        EXPECT_NEAR(spreadOfWhite_px(curve, {1, ratio, bright}), sum / kPixels - 0.5, 1e-6)
            << exponent << " " << bend << " " << ratio;
      }
  EXPECT_NEAR(spreadOfWhite_px<double>({1.0}, {1, 0.1, 0.6}), 0, 1e-12);
}

TEST(DetectedCorners, SidesMoveInward) {
  const std::array<Vector2d, 4> square{Vector2d(10, 10), Vector2d(50, 10), Vector2d(50, 50),
                                       Vector2d(10, 50)};
  const auto smaller = shrunk<double>(square, 0.5);
  EXPECT_LT((smaller[0] - Vector2d(10.5, 10.5)).norm(), 1e-12);
  EXPECT_LT((smaller[2] - Vector2d(49.5, 49.5)).norm(), 1e-12);
  // The other way round it is the same, and a rhombus has sides as far apart.
  const auto turned = shrunk<double>({square[3], square[2], square[1], square[0]}, 0.5);
  EXPECT_LT((turned[3] - smaller[0]).norm(), 1e-12);
  const auto rhombus =
      shrunk<double>({Vector2d(0, 0), Vector2d(40, 10), Vector2d(50, 50), Vector2d(10, 40)}, 1);
  const Vector2d side = Vector2d(40, 10).normalized(), normal(-side.y(), side.x());
  EXPECT_NEAR(normal.dot(rhombus[0]), 1, 1e-12);
  EXPECT_NEAR(normal.dot(rhombus[1]), 1, 1e-12);
}

// Where two black squares meet, what one side's growth takes away the other's gives back.
TEST(DetectedCorners, SaddlePointsStayWhereTheyAre) {
  const std::array<Vector2d, 4> square{Vector2d(10, 10), Vector2d(50, 10), Vector2d(50, 50),
                                       Vector2d(10, 50)};
  EXPECT_EQ(withWhiteSpread<double>(square, 0.5, "tag36h11", {}), shrunk<double>(square, 0.5));
  EXPECT_EQ(withWhiteSpread<double>(square, 0.5, "tag36h11", {.saddle_corners = true}), square);
}

}  // namespace
}  // namespace fathom
