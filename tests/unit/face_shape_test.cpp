#include "core/face_shape.h"

#include <gtest/gtest.h>

#include "effects/registry.h"
#include "imaging/true_panel.h"
#include "support/detections.h"

namespace fathom {
namespace {

const Eigen::Vector2d kHalf_m(0.5, 0.25);

TEST(FaceShape, EachParameterDoesWhatItSays) {
  const Vector3d top_right(0.5, 0.25, 0.01);
  const auto moved = [](const FaceShape<double>& shape, const Vector3d& point) {
    return shape.moved(point, kHalf_m);
  };
  EXPECT_EQ(moved({}, top_right), top_right);
  EXPECT_TRUE(moved({.stretch_x = 0.1}, top_right).isApprox(Vector3d(0.55, 0.25, 0.01)));
  EXPECT_TRUE(moved({.stretch_y = 0.1}, top_right).isApprox(Vector3d(0.5, 0.275, 0.01)));
  EXPECT_TRUE(moved({.shear = 0.1}, top_right).isApprox(Vector3d(0.525, 0.25, 0.01)));
  EXPECT_TRUE(moved({.twist_m = 0.1}, top_right).isApprox(Vector3d(0.5, 0.25, 0.11)));
  EXPECT_TRUE(moved({.twist_m = 0.1}, Vector3d(-0.5, 0.25, 0)).isApprox(Vector3d(-0.5, 0.25, -0.1)));
  EXPECT_TRUE(moved({.bend_m = 0.1}, top_right).isApprox(top_right));
  EXPECT_TRUE(moved({.bend_m = 0.1}, Vector3d::Zero()).isApprox(Vector3d(0, 0, 0.1)));
}

TEST(FaceShape, AFoldTurnsBothHalvesForward) {
  const FaceShape<double> fold{.fold_rad = radians(10)};
  const Vector3d right = fold.moved(Vector3d(0.5, 0, 0), kHalf_m),
                 left = fold.moved(Vector3d(-0.5, 0, 0), kHalf_m);
  EXPECT_NEAR(right.norm(), 0.5, 1e-12);
  EXPECT_GT(right.z(), 0);
  EXPECT_NEAR(std::acos(-right.dot(left) / 0.25), radians(10), 1e-9);
}

// Markers of a true panel have the corners that the forward model predicts.
TEST(FaceShape, TruePanelsMarkersAreShaped) {
  const PanelMap map = test::gridPanel(3, 2);
  EffectParameters<double> effects;
  effects.add<PanelShape>({0.01, -0.02, 0.01, 3, 0.01, 0.02});
  effects.add<MarkerMoved>({1, 0.02, 0.01, 0, 10});
  const PanelMap panel = truePanel(map, effects, 0);
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const auto predicted = markerCorners_panel(map.markers[i], effects, 0),
               there = panel.markers[i].corners_panel();
    for (std::size_t k = 0; k < 4; ++k) EXPECT_TRUE(there[k].isApprox(predicted[k], 1e-12)) << i;
  }
}

TEST(FaceShape, ASurfaceIsCutWhereItBends) {
  Surface sheet;
  for (const auto& [x, y] : {std::pair(-0.5F, -0.25F), std::pair(0.5F, -0.25F), std::pair(0.5F, 0.25F)})
    sheet.vertices.push_back({{x, y, 0}, {0, 0, 1}, {1, 1, 1}});
  sheet.triangles.push_back({0, 1, 2});
  const Surface bent = shaped(sheet, {.bend_m = 0.1}, kHalf_m);
  EXPECT_GT(bent.triangles.size(), 100U);
  float highest = 0;
  for (const auto& vertex : bent.vertices) highest = std::max(highest, vertex.position.z());
  EXPECT_NEAR(highest, 0.1F, 1e-3F);
}

}  // namespace
}  // namespace fathom
