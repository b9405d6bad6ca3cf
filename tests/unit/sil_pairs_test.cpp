// A pair's simulated image against the recorded one where all is known, and pairs that are none.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "image_files/image_file.h"
#include "imaging/image_model.h"
#include "sil/pair_maker.h"
#include "sil/pair_picture.h"
#include "support/shared_data.h"
#include "support/sil_recordings.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

PosedImages posedIn(const RecordingFiles& recording) {
  return posedImages(recording.rawlog, {}, readPanelMaps(test::kDexrovMap), test::silDetection());
}

PairOptions withoutNoise() {
  PairOptions options;
  options.noise = false;
  return options;
}

/// What making this pair complains of.
std::string pairComplaint(const PairMaker& maker, const PosedImage& posed) {
  try {
    maker.make(posed);
  } catch (const Error& error) {
    EXPECT_EQ(error.file, posed.image.file.string());
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.why;
  }
  return "";
}

void overwrite(const fs::path& file, const cv::Mat& image) { ASSERT_TRUE(cv::imwrite(file.string(), image)); }

TEST(SilPairs, EqualTheRecordingWhereAllIsKnownAndNothingIsNoisy) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 2, .noise = false});
  const PosedImages images = test::atTruth(posedIn(recording), recording.rawlog);
  const PairMaker maker(test::silWorld(), withoutNoise(), test::silDetection());
  ASSERT_EQ(images.posed.size(), 2U);
  for (const PosedImage& posed : images.posed) {
    const SilPair pair = maker.make(posed);
    EXPECT_GT(pair.panel_share, 0.1);
    EXPECT_NEAR(pair.range_m, 1.8, 0.4);
    // Truth was stored as angles: a number on the brink of rounding may fall to the other side.
    EXPECT_LE(cv::norm(pair.images.recorded, pair.images.simulated, cv::NORM_INF), 1);
    EXPECT_LE(cv::norm(pair.images.recorded, pair.images.simulated, cv::NORM_L1), 100);
  }
}

// Two readings of the same light: their difference must be as large as the sheet says, and one pixel must not
// tell of the next.
TEST(SilPairs, ResidualIsWhiteOnThePanel) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1});
  const PosedImages images = test::atTruth(posedIn(recording), recording.rawlog);
  const PairMaker maker(test::silWorld(), {}, test::silDetection());
  const SilPair pair = maker.make(images.posed.at(0));
  const cv::Mat residual = luminanceResidual(pair.images);
  const cv::Mat light = radianceOf(pair.images.simulated, maker.camera());
  constexpr std::array kWeights{0.2126, 0.7152, 0.0722};  // red, green, blue
  constexpr double kRounding = 1 / (12 * 255.0 * 255.0);  // variance
  double sum = 0, squares = 0, neighbours = 0, n = 0, both = 0, last = 0;
  for (int v = 0; v < residual.rows; ++v) {
    bool last_counts = false;
    for (int u = 0; u < residual.cols; ++u) {
      const bool counts = pair.images.panel_mask.at<std::uint8_t>(v, u) != 0;
      double variance = 0;
      for (int c = 0; c < 3; ++c) {
        const double sigma = radianceSigma(light.at<cv::Vec3f>(v, u)[c], maker.camera());
        variance += kWeights[static_cast<std::size_t>(c)] * kWeights[static_cast<std::size_t>(c)] * 2 *
                    (sigma * sigma + kRounding);
      }
      const double now = residual.at<float>(v, u) / std::sqrt(variance);
      if (counts) sum += now, squares += now * now, n += 1;
      if (counts && last_counts) neighbours += now * last, both += 1;
      last = now;
      last_counts = counts;
    }
  }
  ASSERT_GT(n, 8000);
  EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 4 * std::sqrt(2 / n) + 0.03);  // shot noise follows the noisy image here
  EXPECT_NEAR(neighbours / both, 0, 4 / std::sqrt(both));
}

TEST(SilPairs, NoiseIsTheOptionsAndNotTheRecordings) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1});
  const PosedImage posed = posedIn(recording).posed.at(0);
  const auto simulated = [&](const PairOptions& options) {
    return PairMaker(test::silWorld(), options, test::silDetection()).make(posed).images.simulated;
  };
  const cv::Mat one = simulated({true, 1});
  EXPECT_EQ(cv::norm(one, simulated({true, 1}), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(one, simulated({true, 2}), cv::NORM_INF), 2);
  EXPECT_GT(cv::norm(one, simulated(withoutNoise()), cv::NORM_INF), 2);
  // Where the recording's noise came out again, the two would be equal.
  EXPECT_GT(cv::norm(one, inColour(readImage(posed.image.file)), cv::NORM_INF), 2);
}

// Without a sea floor the mask is what has been rendered; with it, the same pixels but for those at the rim.
TEST(SilPairs, MaskIsThePanelWithAndWithoutSeaFloor) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1});
  const PosedImage posed = posedIn(recording).posed.at(0);
  KnownWorld hanging = test::silWorld();
  hanging.sea_floor.reset();
  const PairMaker with(test::silWorld(), {}, test::silDetection()),
      without(hanging, {}, test::silDetection());
  const SilPair on_floor = with.make(posed), in_water = without.make(posed);
  EXPECT_LT(cv::countNonZero(on_floor.images.panel_mask != in_water.images.panel_mask), 30);
  EXPECT_EQ(cv::countNonZero(with.comparedRegion(on_floor.images)), 320 * 240);

  const ImagePair compared = without.compared(in_water.images);
  const cv::Mat around = ~in_water.images.panel_mask;
  EXPECT_EQ(cv::norm(compared.recorded, compared.simulated, cv::NORM_INF, around), 0);
  EXPECT_EQ(cv::norm(compared.recorded, in_water.images.recorded, cv::NORM_INF, in_water.images.panel_mask),
            0);
}

TEST(SilPairs, OfAPairBothAreTakenFromWhereTheyAre) {
  const auto recording =
      test::simulateForSil(test::scratchFolder(), {.images = 1, .noise = false, .stereo = true});
  const PosedImages images = test::atTruth(posedIn(recording), recording.rawlog);
  ASSERT_EQ(images.posed.size(), 2U);
  const PairMaker maker(test::silWorld(), withoutNoise(), test::silDetection());
  for (const PosedImage& posed : images.posed) {
    const SilPair pair = maker.make(posed);
    EXPECT_LE(cv::norm(pair.images.recorded, pair.images.simulated, cv::NORM_INF), 1) << posed.eye;
  }
}

TEST(SilPairs, OfAGrayImageTheSimulatedOneIsGrayToo) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1, .noise = false});
  const fs::path file = recording.images / "CAMERA_0000.png";
  overwrite(file, cv::imread(file.string(), cv::IMREAD_GRAYSCALE));
  const PosedImages images = test::atTruth(posedIn(recording), recording.rawlog);
  const SilPair pair =
      PairMaker(test::silWorld(), withoutNoise(), test::silDetection()).make(images.posed.at(0));
  ASSERT_EQ(pair.images.simulated.type(), CV_8UC3);
  EXPECT_LE(cv::norm(pair.images.recorded, pair.images.simulated, cv::NORM_INF), 1);
}

// The same light with and without the encoder's losses: like is compared with like.
TEST(SilPairs, OfAJpegImageTheSimulatedOneWasAJpegToo) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1, .noise = false});
  PosedImages images = test::atTruth(posedIn(recording), recording.rawlog);
  PosedImage& posed = images.posed.at(0);
  const cv::Mat exact = readImage(posed.image.file);
  posed.image.file = recording.images / "lossy.jpg";
  ASSERT_TRUE(cv::imwrite(posed.image.file.string(), exact, {cv::IMWRITE_JPEG_QUALITY, 60}));
  const SilPair pair = PairMaker(test::silWorld(), withoutNoise(), test::silDetection()).make(posed);
  const double loss = cv::norm(pair.images.recorded, exact, cv::NORM_L1);
  EXPECT_GT(loss, 1e4);
  EXPECT_LT(cv::norm(pair.images.recorded, pair.images.simulated, cv::NORM_L1), 0.1 * loss);
}

TEST(SilPairs, OtherPosesAreRefused) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1});
  const PosedImage posed = posedIn(recording).posed.at(0);
  const PairMaker maker(test::silWorld(), {}, test::silDetection());
  EXPECT_EQ(pairComplaint(maker, posed), "");
  const auto turned = [&](double yaw_rad, bool markers) {
    PosedImage other = posed;
    other.T_odom_robot.pose.rotation *= rotationFromYawPitchRoll(yaw_rad, 0, 0);
    if (!markers) other.detections.clear();
    return pairComplaint(maker, other);
  };
  // 0.2 rad are 0.2 * 278 px, and the camera, 0.35 m ahead, moves aside by 0.07 m, 1.6 m from the panel: 12
  // px.
  const std::string why = turned(0.2, true), before = "the pose is not this image's: its markers lie ";
  ASSERT_TRUE(why.starts_with(before)) << why;
  EXPECT_NEAR(std::stod(why.substr(before.size())), 68, 5) << why;
  EXPECT_EQ(turned(3, true), "the pose is not this image's: its markers lie behind the camera");
  EXPECT_EQ(turned(3, false), "no panel is in view from where it was taken");
}

TEST(SilPairs, OtherImagesAreRefused) {
  const auto recording = test::simulateForSil(test::scratchFolder(), {.images = 1});
  const PosedImage posed = posedIn(recording).posed.at(0);
  const PairMaker maker(test::silWorld(), {}, test::silDetection());
  overwrite(posed.image.file, cv::Mat(480, 640, CV_8UC3, cv::Scalar(40, 50, 60)));
  EXPECT_EQ(pairComplaint(maker, posed), "is of 640 x 480 pixels, its camera of 320 x 240");
  overwrite(posed.image.file, cv::Mat(240, 320, CV_8UC3, cv::Scalar(255, 255, 255)));
  EXPECT_NE(pairComplaint(maker, posed).find("saturated"), std::string::npos);
  fs::remove(posed.image.file);
  EXPECT_NE(pairComplaint(maker, posed), "");
}

TEST(SilPairs, ResidualPictureShowsWhichIsBrighter) {
  const CameraSheet camera;
  ImagePair pair;
  pair.camera = &camera;
  pair.recorded = cv::Mat(1, 4, CV_8UC3, cv::Scalar(100, 100, 100));
  pair.simulated = (cv::Mat_<cv::Vec3b>(1, 4) << cv::Vec3b(100, 100, 100), cv::Vec3b(0, 0, 0),
                    cv::Vec3b(200, 200, 200), cv::Vec3b(0, 0, 0));
  cv::Mat region(1, 4, CV_8UC1, cv::Scalar(255));
  region.at<std::uint8_t>(0, 3) = 0;
  const cv::Mat picture = residualPicture(pair, region, {.full_scale = 0.2});
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 1), cv::Vec3b(0x00, 0x5e, 0xd5));  // orange
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 2), cv::Vec3b(0xb2, 0x72, 0x00));  // blue
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 3), cv::Vec3b(128, 128, 128));
  EXPECT_NEAR(luminanceResidual(pair).at<float>(0, 2), -100 / 255.0, 1e-6);
}

TEST(KnownWorld, SeaFloorIsTheSimulationsOrUnknown) {
  const auto folder = test::scratchFolder();
  EXPECT_FALSE(seaFloorOf(folder / "r.rawlog"));
  writeTextFile(folder / "r_simulation.json", R"({"run": {"seed": 3}, "sea_floor_z_m": -5.5})");
  const auto floor = seaFloorOf(folder / "r.rawlog");
  ASSERT_TRUE(floor);
  EXPECT_EQ(floor->z_m, -5.5);
  EXPECT_EQ(floor->sand_seed, 3U);
  for (const char* damaged :
       {"{", R"({"run": {"seed": 3}})", R"({"run": {"seed": "x"}, "sea_floor_z_m": -5.5})"}) {
    std::filesystem::remove(folder / "r_simulation.json");
    writeTextFile(folder / "r_simulation.json", damaged);
    EXPECT_THROW(seaFloorOf(folder / "r.rawlog"), Error) << damaged;
  }
}

}  // namespace
}  // namespace fathom
