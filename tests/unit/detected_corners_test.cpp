// Where edges between black and white seem to be, in images whose numbers are a power of the light.
#include "imaging/detected_corners.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

// Against the sum over pixels on the edge, each with its share of white.
TEST(DetectedCorners, WhiteSpreadsAsPixelsOnTheEdgeSay) {
  constexpr int kPixels = 20000;
  for (const double exponent : {0.45, 0.9, 1.0, 1.3})
    for (const double dark : {0.01, 0.1, 0.5}) {
      double sum = 0;
      for (int i = 0; i < kPixels; ++i) {
        const auto seen = [&](double light) { return predictReading<double>(light, {}, {exponent}); };
        const double light = dark + (1 - dark) * (i + 0.5) / kPixels;
        sum += (seen(light) - seen(dark)) / (1 - seen(dark));
      }
      EXPECT_NEAR(spreadOfWhite_px(exponent, dark), sum / kPixels - 0.5, 1e-6) << exponent << " " << dark;
    }
  EXPECT_NEAR(spreadOfWhite_px(1.0, 0.1), 0, 1e-12);
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
