// Both backends on drawn images of every family, against where the corners truly are.
#include "fiducials/detector.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "support/marker_images.h"

namespace fathom {
namespace {

using test::drawMarkers;
using test::lookingAtPanel;
using test::markerAt;
using test::trueCorners;

TEST(Backends, AreKnownByTheirNames) {
  for (const Backend backend : kBackends) {
    EXPECT_EQ(backendNamed(std::string(nameOf(backend))), backend);
    EXPECT_NE(fallbackOf(backend), backend);
  }
  EXPECT_EQ(backendNames().size(), kBackends.size());
  EXPECT_THROW(backendNamed("artoolkit"), std::invalid_argument);
}

const CameraModel kDrawnCamera;

/// Four markers of a family, the first, the last and two between, upright, on their sides and aslant; a cell
/// is 8 px wide or a little less, whatever the family.
std::vector<Marker> fourMarkers(const std::string& family) {
  const MarkerPattern pattern = markerPattern(family, 0);
  const double size_m = 0.016 * pattern.border_cells;
  const int count = markerCount(family);
  std::vector<Marker> markers;
  markers.reserve(4);
  for (int k = 0; k < 4; ++k)
    markers.push_back(markerAt(family, k * (count - 1) / 3, size_m, k % 2 == 0 ? -0.12 : 0.12,
                               k < 2 ? 0.12 : -0.12, k * radians(100)));
  return markers;
}

class EveryFamily : public testing::TestWithParam<std::string> {};

TEST_P(EveryFamily, IsReadByEveryBackendThatCan) {
  const std::string family = GetParam();
  const auto markers = fourMarkers(family);
  const Pose T_camera_panel = lookingAtPanel(1.0, radians(20), radians(30), radians(10));
  Random random(1);
  test::Look look;
  look.supersampling = 8;
  const cv::Mat image = drawMarkers(markers, kDrawnCamera, T_camera_panel, look, random);
  for (const Backend backend : kBackends) {
    if (!canRead(backend, family)) continue;
    const auto detections = makeDetector(backend, {family})->detect(image);
    ASSERT_EQ(detections.size(), markers.size()) << nameOf(backend);
    for (std::size_t i = 0; i < markers.size(); ++i) {  // sorted by id, as the markers are
      EXPECT_EQ(detections[i].id, markers[i].id);
      EXPECT_EQ(detections[i].family, family);
      EXPECT_TRUE(detections[i].refined);
      const auto truth = trueCorners(markers[i], kDrawnCamera, T_camera_panel);
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT((detections[i].corners_px[k] - truth[k]).norm(), 0.05)
            << nameOf(backend) << " id " << detections[i].id << " corner " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Detector, EveryFamily, testing::ValuesIn(markerFamilies()),
                         [](const auto& family) { return family.param; });

TEST(Detector, OnlyNewTagFamiliesAreClosedToAruco) {
  for (const auto& family : markerFamilies()) {
    EXPECT_TRUE(canRead(Backend::apriltag, family));
    const bool is_new = family.starts_with("tagS") || family.starts_with("tagC");
    EXPECT_EQ(canRead(Backend::aruco, family), !is_new) << family;
  }
  EXPECT_FALSE(canRead(Backend::aruco, "tag99h9"));
}

TEST(Detector, OwnCornersOfTheLibrariesFollowOurConventions) {
  // Not refined, so that a wrong pixel centre (0.7 px aslant) would show in the mean.
  const auto markers = fourMarkers("tag36h11");
  const Pose T_camera_panel = lookingAtPanel(1.0, 0, 0, radians(10));
  Random random(1);
  const cv::Mat image = drawMarkers(markers, kDrawnCamera, T_camera_panel, {}, random);
  DetectorOptions options;
  options.refine = false;
  for (const Backend backend : kBackends) {
    const auto detections = makeDetector(backend, {"tag36h11"}, options)->detect(image);
    ASSERT_EQ(detections.size(), 4U);
    Vector2d mean = Vector2d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_FALSE(detections[i].refined);
      const auto truth = trueCorners(markers[i], kDrawnCamera, T_camera_panel);
      for (std::size_t k = 0; k < 4; ++k) mean += (detections[i].corners_px[k] - truth[k]) / 16.0;
    }
    EXPECT_LT(mean.norm(), hasRoughCorners(backend) ? 0.3 : 0.2) << nameOf(backend);
  }
}

TEST(Detector, TwoFamiliesInOneImageAreToldApart) {
  const std::vector<Marker> markers{markerAt("DICT_ARUCO_ORIGINAL", 17, 0.12, -0.12, 0),
                                    markerAt("tag36h11", 17, 0.12, 0.12, 0)};
  Random random(2);
  const cv::Mat image = drawMarkers(markers, kDrawnCamera, lookingAtPanel(1.0, 0.2), {}, random);
  for (const Backend backend : kBackends) {
    const auto detections = makeDetector(backend, {"tag36h11", "DICT_ARUCO_ORIGINAL"})->detect(image);
    ASSERT_EQ(detections.size(), 2U) << nameOf(backend);
    EXPECT_EQ(detections[0].family, "DICT_ARUCO_ORIGINAL");
    EXPECT_EQ(detections[1].family, "tag36h11");
  }
}

TEST(Detector, FindsNothingInNoise) {
  Random random(3);
  for (const Backend backend : kBackends) {
    const auto detector =
        makeDetector(backend, {"DICT_ARUCO_ORIGINAL", "DICT_6X6_250", "tag36h11", "DICT_5X5_100"});
    for (int i = 0; i < 12; ++i) {
      cv::Mat image(240, 320, CV_8UC1);
      for (int row = 0; row < image.rows; ++row)
        for (int column = 0; column < image.cols; ++column)
          image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(random.uniform(0, 256));
      if (i % 3 > 0) cv::GaussianBlur(image, image, {}, i);  // blobs of many sizes
      if (i % 3 > 0) cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
      EXPECT_TRUE(detector->detect(image).empty()) << nameOf(backend) << " image " << i;
    }
  }
}

TEST(Detector, SameImageSameDetections) {
  const auto markers = fourMarkers("DICT_5X5_100");
  Random random(4);
  test::Look look;
  look.noise_sigma = 4;
  const cv::Mat image = drawMarkers(markers, kDrawnCamera, lookingAtPanel(1.3, 0.4, 1), look, random);
  for (const Backend backend : kBackends) {
    const auto first = makeDetector(backend, {"DICT_5X5_100"})->detect(image);
    const auto detector = makeDetector(backend, {"DICT_5X5_100"});
    detector->detect(cv::Mat(100, 100, CV_8UC1, cv::Scalar(7)));  // no memory of images before
    const auto second = detector->detect(image);
    ASSERT_EQ(first.size(), second.size());
    ASSERT_EQ(first.size(), 4U);
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(first[i].corners_px, second[i].corners_px);
      EXPECT_EQ(first[i].covariance_px2, second[i].covariance_px2);
    }
  }
}

TEST(Detector, ColourIsReadAsGray) {
  Random random(5);
  const cv::Mat gray = drawMarkers(fourMarkers("tag25h9"), kDrawnCamera, lookingAtPanel(1.0, 0), {}, random);
  cv::Mat colour;
  cv::cvtColor(gray, colour, cv::COLOR_GRAY2BGR);
  const auto detector = makeDetector(Backend::apriltag, {"tag25h9"});
  const auto from_gray = detector->detect(gray), from_colour = detector->detect(colour);
  ASSERT_EQ(from_gray.size(), 4U);
  ASSERT_EQ(from_colour.size(), 4U);
  EXPECT_EQ(from_gray[0].corners_px, from_colour[0].corners_px);
}

TEST(Detector, PreprocessingFindsMarkersBehindAVeil) {
  // Four digital numbers between black and white: under ArUco's threshold of seven.
  test::Look veiled;
  veiled.black = 148;
  veiled.white = 152;
  veiled.background = 150;
  veiled.noise_sigma = 0.3;
  Random random(6);
  const cv::Mat image =
      drawMarkers(fourMarkers("DICT_ARUCO_ORIGINAL"), kDrawnCamera, lookingAtPanel(1.0, 0.2), veiled, random);
  DetectorOptions options;
  const auto count = [&] {
    return makeDetector(Backend::aruco, {"DICT_ARUCO_ORIGINAL"}, options)->detect(image).size();
  };
  EXPECT_EQ(count(), 0U);
  options.preprocess = Preprocess::stretch;
  EXPECT_EQ(count(), 4U);
  options.expected_range = GrayRange{148, 152};
  EXPECT_EQ(count(), 4U);
}

TEST(Preprocess, StretchUsesTheWholeRangeAndClaheRaisesLocalContrast) {
  cv::Mat image(100, 200, CV_8UC1, cv::Scalar(100));
  image.colRange(100, 200) = 120;
  const cv::Mat stretched = preprocessed(image, Preprocess::stretch, nullptr);
  EXPECT_NEAR(stretched.at<std::uint8_t>(0, 0), 255.0 * 0.1 / 1.2, 1);
  EXPECT_NEAR(stretched.at<std::uint8_t>(0, 199), 255.0 * 1.1 / 1.2, 1);
  const cv::Mat equalized = preprocessed(image, Preprocess::clahe, nullptr);
  EXPECT_GT(equalized.at<std::uint8_t>(50, 199) - equalized.at<std::uint8_t>(50, 0), 19);
  EXPECT_EQ(preprocessed(image, Preprocess::none, nullptr).data, image.data);
}

TEST(Preprocess, ExpectedRangeIsThatOfTheWaterModel) {
  Water water;
  water.attenuation_per_m = Vector3d::Constant(0.5);
  water.veil = Vector3d::Constant(0.2);
  const auto range = [&](double range_m) {
    return expectedRange(Vector3d::Zero(), Vector3d::Ones(), water, CameraSheet(), range_m);
  };
  EXPECT_NEAR(range(0).black, 0, 1e-9);
  EXPECT_NEAR(range(0).white, 255, 1e-9);
  EXPECT_NEAR(range(2).black, 255 * 0.2 * (1 - std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(range(2).white, 255 * (std::exp(-1.0) + 0.2 * (1 - std::exp(-1.0))), 1e-9);
}

/// Finds what it is told.
class Told : public Detector {
 public:
  explicit Told(std::vector<Detection> detections) : detections_(std::move(detections)) {}
  std::vector<Detection> detect(const cv::Mat&, const std::vector<SearchRegion>&) override {
    ++calls;
    return detections_;
  }
  int calls = 0;

 private:
  std::vector<Detection> detections_;
};

Detection squareAt(int id, double x) {
  Detection detection;
  detection.family = "tag36h11";
  detection.id = id;
  detection.corners_px = {Vector2d(x, 0), {x + 20, 0}, {x + 20, 20}, {x, 20}};
  return detection;
}

TEST(FallbackDetector, AsksTheSecondOnlyWhereTheFirstFoundTooFew) {
  const cv::Mat image(50, 50, CV_8UC1, cv::Scalar(0));
  auto first = std::make_unique<Told>(std::vector{squareAt(3, 100)});
  auto second = std::make_unique<Told>(std::vector{squareAt(1, 0), squareAt(3, 102), squareAt(3, 200)});
  const Told* asked = second.get();
  FallbackDetector satisfied(std::move(first), std::move(second), 1);
  EXPECT_EQ(satisfied.detect(image).size(), 1U);
  EXPECT_EQ(asked->calls, 0);

  FallbackDetector wanting(
      std::make_unique<Told>(std::vector{squareAt(3, 100)}),
      std::make_unique<Told>(std::vector{squareAt(1, 0), squareAt(3, 102), squareAt(3, 200)}), 4);
  const auto detections = wanting.detect(image);
  ASSERT_EQ(detections.size(), 3U);  // the one at 102 is the first's at 100
  EXPECT_EQ(detections[0].id, 1);
  EXPECT_EQ(detections[1].corners_px[0].x(), 100);
  EXPECT_EQ(detections[2].corners_px[0].x(), 200);
}

/// Wherever in the 16 bits a camera puts its own, and however few of them the water leaves.
TEST(Detector, FindsInSixteenBitsWhatItFindsInEight) {
  const auto markers = fourMarkers("tag36h11");
  Random random(2);
  const cv::Mat eight =
      drawMarkers(markers, kDrawnCamera, lookingAtPanel(1.0, radians(20), radians(30), 0), {}, random);
  struct Depth {
    double gain, offset, tolerance_px;
  };
  for (const Backend backend : kBackends) {
    const auto detector = makeDetector(backend, {"tag36h11"});
    const auto expected = detector->detect(eight);
    ASSERT_EQ(expected.size(), 4U);
    for (const auto& [gain, offset, tolerance_px] : {Depth{257, 0, 0},
                                                     {1, 0, 0.05},
                                                     {4, 0, 0.05},
                                                     {0.8, 20000, 0.1},
                                                     {0.3, 4600, 0.2},
                                                     {0.8, 65300, 0.1}}) {
      cv::Mat gray, colour;
      eight.convertTo(gray, CV_16U, gain, offset);
      gray.at<std::uint16_t>(0, 0) = 65535;  // a hot pixel
      cv::cvtColor(gray, colour, cv::COLOR_GRAY2BGR);
      for (const cv::Mat& image : {gray, colour}) {
        const auto found = detector->detect(image);
        ASSERT_EQ(found.size(), 4U) << nameOf(backend) << ", gain " << gain << ", offset " << offset;
        for (std::size_t i = 0; i < 4; ++i)
          EXPECT_LE((found[i].centre_px() - expected[i].centre_px()).norm(), tolerance_px) << gain;
      }
    }
  }
}

TEST(Detector, RejectsWhatItCannotDo) {
  EXPECT_THROW(makeDetector(Backend::aruco, {}), std::invalid_argument);
  EXPECT_THROW(makeDetector(Backend::aruco, {"DICT_9X9"}), std::invalid_argument);
  EXPECT_THROW(makeDetector(Backend::aruco, {"tagStandard41h12"}), std::invalid_argument);
  const auto detector = makeDetector(Backend::aruco, {"DICT_4X4_50"});
  EXPECT_THROW(detector->detect(cv::Mat()), std::invalid_argument);
  EXPECT_THROW(detector->detect(cv::Mat(9, 9, CV_32FC1, cv::Scalar(0))), std::invalid_argument);
  EXPECT_TRUE(detector->detect(cv::Mat(3, 3, CV_8UC1, cv::Scalar(0))).empty());
}

}  // namespace
}  // namespace fathom
