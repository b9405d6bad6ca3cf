// Searching only where markers must be: nothing lost, nothing that the map does not have there.
#include "fiducials/predicted_search.h"

#include <gtest/gtest.h>

#include "support/marker_images.h"

namespace fathom {
namespace {

const CameraModel kSearchCamera;
const std::string kFamily = "DICT_ARUCO_ORIGINAL";

PanelMap panel() {
  PanelMap map;
  int id = 10;
  for (const double y : {-0.3, 0.3})
    for (const double x : {-0.45, 0.0, 0.45})
      map.markers.push_back(test::markerAt(kFamily, id++, 0.16, x, y));
  return map;
}

bool covers(const cv::Rect& area, const std::array<Vector2d, 4>& corners) {
  return std::all_of(corners.begin(), corners.end(), [&](const Vector2d& corner) {
    return area.contains(cv::Point(static_cast<int>(corner.x()), static_cast<int>(corner.y())));
  });
}

TEST(PredictedSearch, FindsAllThatTheWholeImageHas) {
  const PanelMap map = panel();
  Random random(1);
  test::Look look;
  look.supersampling = 6;
  for (const Backend backend : {Backend::aruco, Backend::apriltag}) {
    const auto detector = makeDetector(backend, {kFamily});
    for (const double distance_m : {1.4, 2.6, 0.9}) {
      const Pose truth = test::lookingAtPanel(distance_m, radians(15), random.uniform(0, 6.28), 0.1);
      const cv::Mat image = test::drawMarkers(map.markers, kSearchCamera, truth, look, random);
      PanelPrediction prediction;
      prediction.T_camera_panel = {truth.rotation * expSO3<double>({0.01, -0.01, 0.01}),
                                   truth.position + Vector3d(0.004, -0.003, 0.01)};
      prediction.margin_px = 10;
      const auto whole = detector->detect(image);
      const auto found = detectPredicted(*detector, image, map, kSearchCamera, prediction);
      EXPECT_GE(found.size(), whole.size()) << nameOf(backend) << " " << distance_m;
      EXPECT_GE(whole.size(), distance_m < 1 ? 2U : 6U);
      for (const Detection& detection : found) {
        EXPECT_TRUE(detection.refined);
        const auto corners =
            test::trueCorners(map.markers[static_cast<std::size_t>(detection.id - 10)], kSearchCamera, truth);
        for (std::size_t k = 0; k < 4; ++k)  // full scale, whatever the search's
          EXPECT_LT((detection.corners_px[k] - corners[k]).norm(), 0.1);
      }
    }
  }
}

TEST(PredictedSearch, RejectsIdsThatAreNotExpectedThere) {
  PanelMap map = panel();
  Random random(2);
  const Pose truth = test::lookingAtPanel(1.4, 0.1);
  auto painted = map.markers;
  std::swap(painted[0].id, painted[1].id);
  painted[2].id = 99;
  const cv::Mat image = test::drawMarkers(painted, kSearchCamera, truth, {}, random);
  const auto detector = makeDetector(Backend::aruco, {kFamily});
  const auto found = detectPredicted(*detector, image, map, kSearchCamera, {truth});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].id, 13);
}

TEST(PredictedSearch, AreasGrowWithUncertaintyAndCoverTheTruth) {
  const PanelMap map = panel();
  Random random(3);
  PanelPrediction sure;
  sure.T_camera_panel = test::lookingAtPanel(2, 0.2);
  PanelPrediction unsure = sure;
  unsure.covariance.diagonal() << 4e-4, 4e-4, 4e-4, 1e-3, 1e-3, 1e-3;
  const auto narrow = predictMarkers(map, kSearchCamera, sure),
             wide = predictMarkers(map, kSearchCamera, unsure);
  ASSERT_EQ(narrow.size(), 6U);
  ASSERT_EQ(wide.size(), 6U);
  EXPECT_GT(wide[0].area.area(), narrow[0].area.area());
  int covered = 0;
  constexpr int kRuns = 300;
  for (int n = 0; n < kRuns; ++n) {
    Pose truth = sure.T_camera_panel;
    truth.position += 0.02 * random.normal3();
    truth.rotation *= expSO3<double>(std::sqrt(1e-3) * random.normal3());
    covered += covers(wide[0].area, test::trueCorners(map.markers[0], kSearchCamera, truth));
  }
  EXPECT_GT(covered, kRuns * 98 / 100);
}

TEST(PredictedSearch, LeavesOutWhatCannotBeSeen) {
  const PanelMap map = panel();
  PanelPrediction behind;
  behind.T_camera_panel = test::lookingAtPanel(-2, 0);
  EXPECT_TRUE(predictMarkers(map, kSearchCamera, behind).empty());
  PanelPrediction back;
  back.T_camera_panel = test::lookingAtPanel(2, radians(180));
  EXPECT_TRUE(predictMarkers(map, kSearchCamera, back).empty());
  PanelPrediction aside;
  aside.T_camera_panel = test::lookingAtPanel(2, 0);
  aside.T_camera_panel.position.x() = 9;
  EXPECT_TRUE(predictMarkers(map, kSearchCamera, aside).empty());
}

TEST(PredictedSearch, RegionsAreJoinedWhereThatSavesPixels) {
  std::vector<PredictedMarker> markers;
  for (const cv::Rect& area : {cv::Rect(0, 0, 10, 10), cv::Rect(30, 0, 10, 10), cv::Rect(100, 100, 9, 9),
                               cv::Rect(8, 0, 25, 10), cv::Rect(108, 108, 9, 9)})
    markers.push_back({nullptr, area, static_cast<double>(area.width)});
  const auto regions = searchRegions(markers);
  ASSERT_EQ(regions.size(), 3U);
  EXPECT_EQ(regions[1].area, cv::Rect(0, 0, 40, 10));
  EXPECT_EQ(regions[1].smallest_side_px, 10);
}

}  // namespace
}  // namespace fathom
