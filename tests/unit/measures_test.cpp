// Every registered measure: best on equal images, finite on noisy ones, a reason where it cannot measure.
#include "similarity/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "imaging/image_model.h"
#include "support/textured_images.h"

namespace fathom {
namespace {

const CameraSheet kSheet = [] {
  CameraSheet sheet;
  sheet.response_gamma = 0.45;
  return sheet;
}();

Detection markerSeen(int id, double x_px, double y_px, const std::string& family = "DICT_4X4_50") {
  Detection detection;
  detection.family = family;
  detection.id = id;
  detection.corners_px = {Vector2d(x_px, y_px), Vector2d(x_px + 20, y_px), Vector2d(x_px + 20, y_px + 20),
                          Vector2d(x_px, y_px + 20)};
  return detection;
}

ImagePair equalPair() {
  ImagePair pair;
  pair.recorded = test::texturedImage({160, 120}, 1);
  pair.simulated = pair.recorded.clone();
  pair.panel_mask = cv::Mat::zeros(120, 160, CV_8UC1);
  pair.panel_mask(cv::Rect(20, 10, 100, 80)) = 255;
  pair.camera = &kSheet;
  pair.recorded_detections = pair.simulated_detections = {markerSeen(3, 30, 40), markerSeen(7, 80, 50)};
  return pair;
}

const Measurement& measurementOf(const std::vector<Measurement>& measurements, std::string_view id) {
  for (const auto& measurement : measurements)
    if (measurement.measure->id == id) return measurement;
  throw std::out_of_range(std::string(id));
}

MeasureOutcome outcomeOf(const ImagePair& pair, const std::string& id) {
  return PairMeasurer({id}).measure(pair).at(0).outcome;
}

TEST(Measures, HaveIdsOfTheirOwnAndALineEach) {
  std::set<std::string_view> ids;
  for (const auto& measure : kMeasures) {
    EXPECT_TRUE(ids.insert(measure.id).second) << measure.id;
    EXPECT_FALSE(measure.about.empty());
    EXPECT_EQ(measure.about.find('\n'), std::string_view::npos);
    EXPECT_FALSE(measure.quantities.empty());
    for (const auto& quantity : measure.quantities) EXPECT_FALSE(quantity.unit.empty()) << quantity.name;
  }
}

TEST(Measures, AreBestOnEqualImages) {
  for (const auto& [measure, outcome] : PairMeasurer().measure(equalPair())) {
    EXPECT_EQ(outcome.why_not, "") << measure->id;
    ASSERT_EQ(outcome.values.size(), measure->quantities.size()) << measure->id;
    for (std::size_t i = 0; i < outcome.values.size(); ++i)
      EXPECT_EQ(outcome.values[i], measure->quantities[i].better == Better::higher ? 1.0 : 0.0)
          << measure->quantities[i].name;
  }
}

TEST(Measures, AreFiniteAndWorseOnNoisyImages) {
  ImagePair pair = equalPair();
  pair.simulated = test::noisy(pair.recorded, 20, 2);
  pair.simulated_detections = {markerSeen(3, 31, 40), markerSeen(8, 80, 50)};
  for (const auto& [measure, outcome] : PairMeasurer().measure(pair)) {
    ASSERT_EQ(outcome.values.size(), measure->quantities.size()) << measure->id << ": " << outcome.why_not;
    for (std::size_t i = 0; i < outcome.values.size(); ++i) {
      ASSERT_TRUE(outcome.values[i]) << measure->quantities[i].name;
      EXPECT_TRUE(std::isfinite(*outcome.values[i])) << measure->quantities[i].name;
      if (measure->quantities[i].better == Better::higher)
        EXPECT_LT(*outcome.values[i], 0.99) << measure->quantities[i].name;
      else
        EXPECT_GT(*outcome.values[i], 0.001) << measure->quantities[i].name;
    }
  }
}

TEST(Measures, SayWhyOnABadPairAndMeasureTheNext) {
  const PairMeasurer measurer;
  const auto reasonsFor = [&](auto&& spoil) {
    ImagePair pair = equalPair();
    spoil(pair);
    std::set<std::string> reasons;
    for (const auto& [measure, outcome] : measurer.measure(pair)) {
      EXPECT_TRUE(outcome.values.empty()) << measure->id;
      reasons.insert(outcome.why_not);
    }
    for (const auto& [measure, outcome] : measurer.measure(equalPair()))
      EXPECT_EQ(outcome.why_not, "") << measure->id;
    EXPECT_EQ(reasons.size(), 1U);
    return *reasons.begin();
  };
  EXPECT_EQ(reasonsFor([](ImagePair& pair) { pair.recorded = cv::Mat(); }), "the recorded image is empty");
  EXPECT_EQ(reasonsFor([](ImagePair& pair) { pair.simulated = cv::Mat(); }), "the simulated image is empty");
  EXPECT_EQ(reasonsFor([](ImagePair& pair) {
              pair.simulated = test::texturedImage({120, 160}, 1);
            }),
            "the recorded image is of 160 x 120 pixels, the simulated one of 120 x 160");
  EXPECT_EQ(reasonsFor([](ImagePair& pair) { pair.simulated.convertTo(pair.simulated, CV_16U); }),
            "the simulated image is not of three channels of 8 bits");
  for (const double level : {0.0, 255.0})
    EXPECT_EQ(reasonsFor([&](ImagePair& pair) {
                pair.recorded = cv::Scalar::all(level);
                pair.recorded(cv::Rect(0, 0, 12, 12)) = cv::Scalar::all(99);  // 0.75 % of it
              }),
              "the recorded image is saturated: nearly all of it is black or white");
}

TEST(Measures, SayWhatIsMissing) {
  const auto why = [](const std::string& id, auto&& spoil) {
    ImagePair pair = equalPair();
    spoil(pair);
    return outcomeOf(pair, id).why_not;
  };
  EXPECT_EQ(why("rmse-linear", [](ImagePair& pair) { pair.camera = nullptr; }), "the camera is not known");
  EXPECT_EQ(why("rmse-linear", [](ImagePair& pair) { pair.panel_mask = cv::Mat(); }),
            "where the panel is in the image is not known");
  EXPECT_EQ(why("rmse-linear", [](ImagePair& pair) { pair.panel_mask = cv::Scalar(0); }),
            "the panel is not in the image");
  EXPECT_NE(why("rmse-linear", [](ImagePair& pair) { pair.panel_mask.create(12, 16, CV_8UC1); }), "");
  CameraSheet deep = kSheet;
  deep.bits = 12;
  EXPECT_EQ(why("rmse-linear", [&](ImagePair& pair) { pair.camera = &deep; }),
            "the camera has 12 bits, the images 8");
  EXPECT_EQ(why("detection-agreement",
                [](ImagePair& pair) {
                  pair.recorded_detections.clear();
                  pair.simulated_detections.clear();
                }),
            "no marker was found in either image");
  const auto plain = [](ImagePair& pair) { pair.recorded = pair.simulated = cv::Scalar(90, 60, 30); };
  EXPECT_EQ(why("fsim", plain), "there is nothing to see in either image");
  EXPECT_EQ(why("fsimc", plain), "there is nothing to see in either image");
  const auto shrink = [](ImagePair& pair) {
    pair.recorded = pair.recorded(cv::Rect(0, 0, 47, 60)), pair.simulated = pair.recorded;
  };
  EXPECT_NE(why("fsim", shrink).find("47 x 60"), std::string::npos);
  for (const char* id : {"fsim", "fsimc", "ssim"})  // need neither
    EXPECT_EQ(why(id, [](ImagePair& pair) { pair.panel_mask = cv::Mat(), pair.camera = nullptr; }), "");
}

TEST(Measures, FsimIsTheComparers) {
  ImagePair pair = equalPair();
  pair.simulated = test::blurred(pair.recorded, 2);
  const auto score = FsimComparer().compare(pair.recorded, pair.simulated);
  const auto measurements = PairMeasurer().measure(pair);
  EXPECT_EQ(measurementOf(measurements, "fsim").outcome.values[0], score->fsim);
  EXPECT_EQ(measurementOf(measurements, "fsimc").outcome.values[0], score->fsimc);
}

TEST(Measures, RmseIsOfLightOnThePanelOnly) {
  ImagePair pair = equalPair();
  pair.recorded.setTo(cv::Scalar(100, 150, 200));
  pair.simulated.setTo(cv::Scalar(7, 7, 7));
  pair.simulated.setTo(cv::Scalar(110, 150, 190), pair.panel_mask);
  const double blue = radianceOf(110, kSheet) - radianceOf(100, kSheet),
               red = radianceOf(200, kSheet) - radianceOf(190, kSheet);
  // Radiances are held in single precision.
  EXPECT_NEAR(*outcomeOf(pair, "rmse-linear").values[0], std::sqrt((blue * blue + red * red) / 3), 1e-6);
}

TEST(Measures, DetectionsAgreeByFamilyIdAndPlace) {
  ImagePair pair = equalPair();
  // 1 twice in both, in another order; 2 in both but of two families; 5 only recorded.
  pair.recorded_detections = {markerSeen(1, 10, 10), markerSeen(1, 100, 10), markerSeen(2, 50, 50),
                              markerSeen(5, 90, 60)};
  pair.simulated_detections = {markerSeen(1, 103, 14), markerSeen(1, 10, 10),
                               markerSeen(2, 50, 50, "tag36h11")};
  const auto outcome = outcomeOf(pair, "detection-agreement");
  EXPECT_EQ(outcome.values[0], 2.0 / 5);
  EXPECT_EQ(outcome.values[1], 2.0);
  EXPECT_EQ(outcome.values[2], 1.0);
  EXPECT_NEAR(*outcome.values[3], 5 / std::sqrt(2), 1e-12);

  pair.simulated_detections.clear();
  const auto nothing_in_common = outcomeOf(pair, "detection-agreement");
  EXPECT_EQ(nothing_in_common.why_not, "");
  EXPECT_EQ(nothing_in_common.values[0], 0.0);
  EXPECT_FALSE(nothing_in_common.values[3]);
}

TEST(Measures, AreChosenById) {
  const auto measurements = PairMeasurer({"ssim", "fsim"}).measure(equalPair());
  ASSERT_EQ(measurements.size(), 2U);
  EXPECT_EQ(measurements[0].measure->id, "ssim");
  EXPECT_EQ(measurements[1].measure->id, "fsim");
  EXPECT_THROW(PairMeasurer({"ssim", "ssim"}), Error);
  try {
    const PairMeasurer unknown({"likeness"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.why.find("fsim, fsimc, ssim, rmse-linear, detection-agreement"), std::string::npos);
  }
}

}  // namespace
}  // namespace fathom
