// Scores of detections that are made up, so that what they must be is known.
#include "evaluation/marker_score.h"

#include <gtest/gtest.h>

#include "evaluation/recorded_fiducials.h"
#include "render/renderer.h"
#include "support/panels.h"
#include "support/shipped.h"

namespace fathom {
namespace {

using test::kSource;
constexpr double kTolerance_px = 3;

/// The dexrov panel from two metres in front, turned half a turn so that it stands upright in the image.
struct Scene {
  PanelMap map = readPanelMap(kSource / "maps/dexrov/panel.yaml");
  CameraModel camera;
  Pose T_camera_panel{Eigen::AngleAxisd(radians(180), Vector3d::UnitX()).toRotationMatrix(), {0, 0, 2}};

  std::vector<MarkerPlace> places(const cv::Mat& range_m = {}) const {
    return placesOf(map, camera, T_camera_panel, range_m);
  }
  std::vector<Detection> perfect() const {
    std::vector<Detection> detections;
    for (const MarkerPlace& place : places()) {
      Detection& detection = detections.emplace_back();
      detection.family = place.marker->family;
      detection.id = place.marker->id;
      detection.corners_px = place.corners_px;
      detection.covariance_px2 *= 0.01;
    }
    return detections;
  }
};

TEST(MarkerScore, CountsWhatIsFoundMissedAndWrong) {
  const Scene scene;
  auto detections = scene.perfect();
  ASSERT_EQ(detections.size(), 12U);
  detections.erase(detections.begin() + 4);                                    // one missed
  for (auto& corner : detections[0].corners_px) corner += Vector2d(0.3, 0.4);  // half a pixel off
  detections[1].corners_px[2].x() += 3.01;                                     // misplaced: missed and false
  detections[2].corners_px[2].x() += 2.99;                                     // just right
  detections[3].id = 1000;                                                     // misread: missed and false
  Detection twice = detections[5];
  twice.corners_px[0].x() += 1;  // the worse of two
  detections.insert(detections.begin(), twice);
  const ImageScore score = scoreDetections(detections, scene.places(), kTolerance_px);
  EXPECT_EQ(score.visible, 12);
  EXPECT_EQ(score.found, 9);
  EXPECT_EQ(score.wrong, 3);
  EXPECT_EQ(score.unknown, 1);
  EXPECT_NEAR(score.squares_px2, 4 * 0.25 + 2.99 * 2.99, 1e-9);

  ScoreTally tally;
  tally.add(score);
  tally.add(scoreDetections({}, scene.places(), kTolerance_px));
  EXPECT_EQ(tally.images(), 2U);
  EXPECT_DOUBLE_EQ(tally.detectionRate(), 9.0 / 24.0);
  EXPECT_EQ(tally.wrong(), 3U);
  EXPECT_NEAR(tally.cornerRms_px(), std::sqrt((1.0 + 2.99 * 2.99) / 36), 1e-12);
}

TEST(MarkerScore, NothingSeenIsNotANumber) {
  const ScoreTally tally;
  EXPECT_TRUE(std::isnan(tally.detectionRate()));
  EXPECT_TRUE(std::isnan(tally.cornerRms_px()));
  EXPECT_TRUE(std::isnan(tally.medianPositionError_m()));
}

TEST(MarkerScore, PoseErrorIsTheDifferenceOfPoses) {
  const Scene scene;
  ImageScore score;
  scorePose(scene.perfect(), scene.map, scene.camera, scene.T_camera_panel, score);
  ASSERT_TRUE(score.posed);
  EXPECT_LT(score.position_error_m, 1e-6);
  EXPECT_LT(score.angle_error_rad, 1e-6);
  // Against another truth the error is how far that one is.
  const Pose other{scene.T_camera_panel.rotation * expSO3<double>({0, 0, 0.02}),
                   scene.T_camera_panel.position + Vector3d(0.03, 0, 0.04)};
  scorePose(scene.perfect(), scene.map, scene.camera, other, score);
  EXPECT_NEAR(score.position_error_m, 0.05, 1e-6);
  EXPECT_NEAR(score.angle_error_rad, 0.02, 1e-6);
  scorePose({}, scene.map, scene.camera, other, score);
  EXPECT_FALSE(score.posed);
}

TEST(MarkerScore, MarkersCutByTheImageNeedNotBeFound) {
  Scene scene;
  scene.T_camera_panel.position.x() = 0.5;  // to the right: the last column is cut or out
  const auto places = scene.places();
  EXPECT_EQ(places.size(), 12U);
  for (const MarkerPlace& place : places) {
    // Seen straight on, a marker is a square in the image: an eighth of its side is its quiet zone.
    const double quiet_px = (place.corners_px[1] - place.corners_px[0]).norm() / 8;
    const double right_px = std::max(place.corners_px[1].x(), place.corners_px[3].x()) + quiet_px;
    EXPECT_EQ(place.visible, right_px < scene.camera.width_px - 0.5) << right_px;
  }
  const ImageScore score = scoreDetections(scene.perfect(), places, kTolerance_px);
  EXPECT_LT(score.visible, 12);
  EXPECT_EQ(score.found, score.visible);
  EXPECT_EQ(score.wrong, 0);  // right ones outside count neither way
}

TEST(MarkerScore, MarkersBehindTheCameraOrSeenFromTheBackAreNotThere) {
  Scene scene;
  scene.T_camera_panel = Pose{Matrix3d::Identity(), {0, 0, 2}};  // its z axis goes away from the camera
  for (const MarkerPlace& place : scene.places()) EXPECT_FALSE(place.visible);
  scene.T_camera_panel.position.z() = -2;
  EXPECT_TRUE(scene.places().empty());
}

TEST(MarkerScore, WhatStandsInFrontHidesAMarker) {
  const Scene scene;
  Renderer renderer(scene.camera);
  renderer.setScene(surfaceOf(scene.map));
  const View view = renderer.render(scene.T_camera_panel.inverse(), {});
  for (const MarkerPlace& place : scene.places(view.range_m)) EXPECT_TRUE(place.visible) << place.marker->id;

  // A bar 3 cm wide, 5 cm in front of the third marker's left edge.
  const Vector3d centre = scene.map.markers[2].T_panel_marker.position;
  Surface scene_with_bar = surfaceOf(scene.map);
  const auto first = static_cast<std::uint32_t>(scene_with_bar.vertices.size());
  for (const auto& [x, y] :
       {std::pair(-0.10, -0.1), std::pair(-0.07, -0.1), std::pair(-0.07, 0.1), std::pair(-0.10, 0.1)})
    scene_with_bar.vertices.push_back({(centre + Vector3d(x, y, 0.05)).cast<float>(),
                                       Eigen::Vector3f::UnitZ(), Eigen::Vector3f::Constant(0.5f)});
  scene_with_bar.triangles.push_back({first, first + 1, first + 2});
  scene_with_bar.triangles.push_back({first, first + 2, first + 3});
  renderer.setScene(scene_with_bar);
  const View hidden = renderer.render(scene.T_camera_panel.inverse(), {});
  for (const MarkerPlace& place : scene.places(hidden.range_m))
    EXPECT_EQ(place.visible, place.marker != &scene.map.markers[2]) << place.marker->id;
}

// Newcombe (1998), Statistics in Medicine 17, table I, method 3: the score interval without continuity
// correction, four digits.
TEST(WilsonInterval, HasNewcombesValues) {
  const auto expectInterval = [](std::size_t hits, std::size_t count, double low, double high) {
    const auto [l, h] = wilsonInterval(hits, count);
    EXPECT_NEAR(l, low, 5e-5) << hits << "/" << count;
    EXPECT_NEAR(h, high, 5e-5) << hits << "/" << count;
  };
  expectInterval(81, 263, 0.2553, 0.3662);
  expectInterval(15, 148, 0.0624, 0.1605);
  expectInterval(0, 20, 0.0, 0.1611);
  expectInterval(1, 29, 0.0061, 0.1718);
  EXPECT_EQ(wilsonInterval(0, 0), std::pair(0.0, 1.0));
  EXPECT_EQ(wilsonInterval(20, 20).second, 1.0);
}

TEST(ReaderAgreement, CountsWhatBothSee) {
  const auto first = Scene{}.perfect();
  auto second = first;
  for (auto& corner : second[0].corners_px) corner.x() += 1;
  second[1].corners_px[0].y() += 5;
  second.erase(second.begin() + 7, second.begin() + 9);
  const ReaderAgreement agreement = agreementOf(first, second, kTolerance_px);
  EXPECT_EQ(agreement.both, 9);
  EXPECT_EQ(agreement.only_first, 3);
  EXPECT_EQ(agreement.only_second, 1);
  EXPECT_NEAR(agreement.squares_px2, 4, 1e-9);
}

}  // namespace
}  // namespace fathom
