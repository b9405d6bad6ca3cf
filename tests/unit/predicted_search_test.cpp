// Searching only where markers must be: nothing lost, nothing that the map does not have there.
#include "fiducials/predicted_search.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

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
  for (const Backend backend : kBackends) {
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

/// A filter's prediction, 1 cm and 0.3 degrees from the truth.
PanelPrediction predictionNear(const Pose& truth, Random& random) {
  PanelPrediction prediction;
  prediction.T_camera_panel = {truth.rotation * expSO3<double>(radians(0.3) * random.normal3()),
                               truth.position + 0.01 * random.normal3()};
  prediction.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 2.7e-5, 2.7e-5, 2.7e-5;
  prediction.margin_px = 4;
  return prediction;
}

double farthestCorner_px(const Detection& a, const std::array<Vector2d, 4>& corners) {
  double farthest = 0;
  for (std::size_t k = 0; k < 4; ++k) farthest = std::max(farthest, (a.corners_px[k] - corners[k]).norm());
  return farthest;
}

/// Views of all sorts: near ones that cut markers off, far ones with cells of 3 px, aslant, rolled, dim.
TEST(PredictedSearch, EqualsTheWholeImageOverManyViews) {
  for (const std::string family : {"DICT_ARUCO_ORIGINAL", "tag36h11"}) {
    PanelMap map = panel();
    for (Marker& marker : map.markers) marker.family = family;
    Random random(4);
    double whole_squares = 0, found_squares = 0;
    std::size_t whole_count = 0, found_count = 0;
    for (int i = 0; i < 30; ++i) {
      const double distance_m = random.uniform(0.7, 3.0);
      const Pose truth = test::lookingAtPanel(distance_m, random.uniform(0, 0.7), random.uniform(0, 6.28),
                                              random.uniform(0, 6.28));
      test::Look look;
      look.supersampling = 3;
      look.black = 60;
      look.white = random.uniform(100, 220);
      const cv::Mat image = test::drawMarkers(map.markers, kSearchCamera, truth, look, random);
      const auto detector = makeDetector(kBackends[i % kBackends.size()], {family});
      const auto whole = detector->detect(image);
      const auto found = detectPredicted(*detector, image, map, kSearchCamera, predictionNear(truth, random));
      whole_count += whole.size();
      found_count += found.size();
      const auto error_px = [&](const Detection& detection) {
        const auto& marker = map.markers[static_cast<std::size_t>(detection.id - 10)];
        return farthestCorner_px(detection, test::trueCorners(marker, kSearchCamera, truth));
      };
      for (const Detection& detection : whole) {
        const auto same = std::find_if(found.begin(), found.end(),
                                       [&](const Detection& d) { return d.id == detection.id; });
        ASSERT_NE(same, found.end()) << family << " " << i << ", id " << detection.id;
        whole_squares += std::pow(error_px(detection), 2);
        found_squares += std::pow(error_px(*same), 2);
      }
      for (const Detection& detection : found) EXPECT_LT(error_px(detection), 1.0) << family << " " << i;
    }
    EXPECT_GE(found_count, whole_count);
    EXPECT_GT(whole_count, 100U);                   // of 180
    EXPECT_LT(found_squares, 1.1 * whole_squares);  // as exact
  }
}

/// Counts the pixels searched by a library.
class Watched : public Detector {
 public:
  explicit Watched(std::unique_ptr<Detector> detector) : detector_(std::move(detector)) {}
  std::vector<Detection> detect(const cv::Mat& image, const std::vector<SearchRegion>& regions) override {
    for (const SearchRegion& region : regions) searched_px += region.area.area();
    return detector_->detect(image, regions);
  }
  std::optional<Detection> confirm(const cv::Mat& gray, const ExpectedMarker& expected) override {
    return detector_->confirm(gray, expected);
  }
  int searched_px = 0;

 private:
  std::unique_ptr<Detector> detector_;
};

TEST(PredictedSearch, SearchesNothingWhereAllIsConfirmed) {
  const PanelMap map = panel();
  Random random(5);
  const Pose truth = test::lookingAtPanel(1.6, 0.3, 1, 0.2);
  const cv::Mat image = test::drawMarkers(map.markers, kSearchCamera, truth, {}, random);
  Watched detector(makeDetector(Backend::aruco, {kFamily}));
  EXPECT_EQ(detectPredicted(detector, image, map, kSearchCamera, predictionNear(truth, random)).size(), 6U);
  EXPECT_EQ(detector.searched_px, 0);
}

/// Off by ten times what it claims: what the areas still hold is found by search, and nothing else.
TEST(PredictedSearch, WrongPredictionGivesNothingFalse) {
  const PanelMap map = panel();
  Random random(6);
  const auto detector = makeDetector(Backend::aruco, {kFamily});
  for (int i = 0; i < 20; ++i) {
    const Pose truth = test::lookingAtPanel(1.6, 0.3, i);
    test::Look look;
    look.supersampling = 2;
    const cv::Mat image = test::drawMarkers(map.markers, kSearchCamera, truth, look, random);
    PanelPrediction prediction = predictionNear(truth, random);
    prediction.T_camera_panel.position += 0.1 * random.normal3();
    prediction.T_camera_panel.rotation *= expSO3<double>(0.1 * random.normal3());
    const auto markers = predictMarkers(map, kSearchCamera, prediction);
    std::vector<int> in_place;
    for (const Detection& detection : detector->detect(image, searchRegions(markers)))
      for (const PredictedMarker& marker : markers)
        if (marker.marker->id == detection.id &&
            marker.area.contains(cv::Point(static_cast<int>(detection.centre_px().x()),
                                           static_cast<int>(detection.centre_px().y()))))
          in_place.push_back(detection.id);
    const auto found = detectPredicted(*detector, image, map, kSearchCamera, prediction);
    for (const int id : in_place)
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const auto& d) { return d.id == id; })) << i;
    for (const Detection& detection : found) {
      const auto& marker = map.markers[static_cast<std::size_t>(detection.id - 10)];
      EXPECT_LT(farthestCorner_px(detection, test::trueCorners(marker, kSearchCamera, truth)), 0.2) << i;
    }
  }
}

TEST(PredictedSearch, NothingOnAnEmptyPanel) {
  const PanelMap map = panel();
  Random random(7);
  const Pose truth = test::lookingAtPanel(1.6, 0.1);
  auto others = map.markers;  // square for square, another code
  for (Marker& marker : others) marker.id += 500;
  const cv::Mat image = test::drawMarkers(others, kSearchCamera, truth, {}, random);
  cv::Mat noise(image.size(), CV_8UC1);
  for (int row = 0; row < noise.rows; ++row)
    for (int column = 0; column < noise.cols; ++column)
      noise.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(random.uniform(0, 256));
  for (const Backend backend : kBackends) {
    const auto detector = makeDetector(backend, {kFamily});
    EXPECT_TRUE(detectPredicted(*detector, image, map, kSearchCamera, {truth}).empty());
    EXPECT_TRUE(detectPredicted(*detector, noise, map, kSearchCamera, {truth}).empty());
  }
}

/// Something gray lies over a quarter of a marker, then over one side's border, then over all of it.
TEST(PredictedSearch, CoveredMarkersAreNotReported) {
  const PanelMap map = panel();
  Random random(8);
  const Pose truth = test::lookingAtPanel(1.4, 0.1);
  const cv::Mat clean = test::drawMarkers(map.markers, kSearchCamera, truth, {}, random);
  const auto corners = test::trueCorners(map.markers[0], kSearchCamera, truth);
  const auto covered = [&](double width, double height) {
    cv::Mat image = clean.clone();
    const Vector2d size = corners[2] - corners[0];
    cv::rectangle(image, cv::Point2d(corners[0].x() - 6, corners[0].y() - 6),
                  cv::Point2d(corners[0].x() + width * size.x(), corners[0].y() + height * size.y()),
                  cv::Scalar(150), cv::FILLED);
    return image;
  };
  for (const Backend backend : kBackends) {
    const auto detector = makeDetector(backend, {kFamily});
    EXPECT_EQ(detectPredicted(*detector, clean, map, kSearchCamera, {truth}).size(), 6U);
    for (const cv::Mat& image : {covered(0.5, 0.5), covered(1.2, 0.2), covered(1.2, 1.2)}) {
      const auto found = detectPredicted(*detector, image, map, kSearchCamera, {truth});
      ASSERT_EQ(found.size(), 5U) << nameOf(backend);
      EXPECT_EQ(found[0].id, 11);
    }
  }
}

/// A single wrong bit is no marker of a family that cannot correct one, and one of a family that can.
TEST(PredictedSearch, ForgivesWrongBitsAsTheFamilyAllows) {
  for (const std::string family : {"DICT_ARUCO_ORIGINAL", "tag36h11"}) {
    const Marker marker = test::markerAt(family, 10, 0.3, 0, 0);
    Random random(9);
    const Pose truth = test::lookingAtPanel(1.2, 0.0);
    cv::Mat image = test::drawMarkers({marker}, kSearchCamera, truth, {}, random);
    const auto detector = makeDetector(Backend::apriltag, {family});
    const ExpectedMarker expected{family, 10, test::trueCorners(marker, kSearchCamera, truth), 0.1, {}};
    const auto clean = detector->confirm(image, expected);
    ASSERT_TRUE(clean) << family;
    EXPECT_EQ(clean->corrected_bits, 0);
    const MarkerPattern pattern = markerPattern(family, 10);
    const int n = pattern.border_cells, origin = (pattern.cells - n) / 2, middle = n / 2;
    const double cell_px = (expected.corners_px[1] - expected.corners_px[0]).norm() / n;
    const Vector2d first = expected.corners_px[0] + cell_px * Vector2d(middle, middle);
    cv::rectangle(image, cv::Rect2d(first.x(), first.y(), cell_px, cell_px),
                  cv::Scalar(pattern.whiteAt(origin + middle, origin + middle) ? 30 : 200), cv::FILLED);
    const auto damaged = detector->confirm(image, expected);
    EXPECT_EQ(damaged.has_value(), family == "tag36h11");
    if (damaged) {
      EXPECT_EQ(damaged->corrected_bits, 1);
    }
  }
}

TEST(PredictedSearch, LocatesAMarkerWithinThreeSigma) {
  Random random(10);
  for (const double distance_m : {0.6, 1.2, 2.4}) {
    const Marker marker = test::markerAt(kFamily, 10, 0.16, 0, 0);
    const Pose truth = test::lookingAtPanel(distance_m, 0.3, 1, 0.4);
    const cv::Mat image = test::drawMarkers({marker}, kSearchCamera, truth, {}, random);
    const auto corners = test::trueCorners(marker, kSearchCamera, truth);
    const double cell_px = (corners[1] - corners[0]).norm() / 7;
    ExpectedMarker expected{kFamily, 10, corners, 5, {}};
    const Vector2d shift(11.3, -8.6);
    for (Vector2d& corner : expected.corners_px) corner += shift;
    const auto located = locateMarker(image, markerPattern(kFamily, 10), expected);
    ASSERT_TRUE(located) << distance_m;
    // Half a pixel of the image scaled down, in both directions, and some for noise.
    EXPECT_LT(((*located)[0] - corners[0]).norm(), 0.8 * std::max(1.0, cell_px / 3)) << distance_m;
    expected.sigma_px = 1;  // too sure
    const auto strayed = locateMarker(image, markerPattern(kFamily, 10), expected);
    EXPECT_FALSE(strayed && ((*strayed)[0] - corners[0]).norm() < 3) << distance_m;
  }
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
