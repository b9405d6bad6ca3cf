// What a study of water is put together from: which images, the paper's search, which water is recommended.
#include "environment/water_study.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <set>

#include "core/files.h"
#include "image_files/jpeg.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {

/// Images on a way towards the panel, one a second.
std::vector<PosedImage> approachTo(const PanelMap& panel, std::size_t count) {
  std::vector<PosedImage> images;
  for (std::size_t i = 0; i < count; ++i) {
    PosedImage image;
    image.number = i;
    const double range_m = 5 - 4 * static_cast<double>(i) / static_cast<double>(count);
    image.T_odom_robot.pose =  // with the camera in its middle
        panel.T_odom_panel * Pose{Matrix3d(Vector3d(1, -1, -1).asDiagonal()), {0, 0, range_m}};
    image.T_odom_robot.covariance = 1e-8 * Matrix6d::Identity();
    images.push_back(image);
  }
  return images;
}

TEST(ImageChoice, HoldsOutWholeStretchesAndCoversTheRange) {
  const std::vector<PanelMap> panels{readPanelMap(test::kDexrovMap)};
  std::vector<PosedImage> images = approachTo(panels[0], 240);
  images[7].T_odom_robot.covariance *= 1e6;  // 10 cm
  ImageChoiceOptions options;
  options.images = 30;
  const ImageChoice choice = chooseImages(images, panels, options);
  EXPECT_EQ(choice.too_uncertain, 1U);
  ASSERT_EQ(choice.fitted.size(), 30U);
  ASSERT_EQ(choice.held_out.size(), 24U);
  EXPECT_TRUE(std::is_sorted(choice.fitted.begin(), choice.fitted.end()));
  EXPECT_EQ(std::set<std::size_t>(choice.fitted.begin(), choice.fitted.end()).count(7), 0U);
  EXPECT_LT(choice.fitted.front(), 5U);
  EXPECT_GT(choice.fitted.back(), 234U);
  // Between two held-out images of one stretch none is fitted on: held-out ones come in runs.
  int runs = 0;
  for (std::size_t k = 1; k < choice.held_out.size(); ++k) {
    const auto between = std::count_if(choice.fitted.begin(), choice.fitted.end(), [&](std::size_t i) {
      return i > choice.held_out[k - 1] && i < choice.held_out[k];
    });
    runs += between > 0 ? 1 : 0;
  }
  EXPECT_LE(runs, 6);
}

TEST(FsimSearch, ClimbsToTheBestWater) {
  const Environment start = readEnvironment(test::kConfig / "water_clear.yaml");
  const Vector9d best = waterParameters(readEnvironment(test::kConfig / "water_turbid.yaml"));
  int asked = 0;
  const auto similarity = [&](const Environment& water) {
    ++asked;
    return -(waterParameters(water).head<6>() - best.head<6>()).cwiseAbs().maxCoeff() -
           (waterParameters(water).head<6>() - best.head<6>()).squaredNorm();
  };
  FsimSearchOptions options;
  options.evaluations = 1000;
  const FsimSearch search = searchByFsim(start, similarity, options);
  EXPECT_EQ(search.evaluations, static_cast<std::size_t>(asked));
  EXPECT_GT(search.similarity, 0.3 * similarity(start));
  EXPECT_EQ(search.environment.ambient, start.ambient);
  options.evaluations = 10;
  EXPECT_EQ(searchByFsim(start, similarity, options).evaluations, 10U);
}

WaterCandidate candidate(const std::vector<double>& rmse, double fsim) {
  WaterCandidate water;
  for (const double value : rmse) water.scores.push_back({fsim, fsim, value});
  return water;
}

TEST(WaterScores, HeldOutImagesDecide) {
  // Clearly the smallest RMSE wins, whatever its FSIM.
  EXPECT_EQ(recommended({candidate({0.05, 0.06, 0.07}, 0.9), candidate({0.02, 0.03, 0.04}, 0.8)}, 2), 1U);
  // Where it tells nothing, the larger FSIM.
  EXPECT_EQ(recommended({candidate({0.03, 0.02, 0.04}, 0.9), candidate({0.02, 0.03, 0.03}, 0.8)}, 2), 0U);
  // Truth is not for sale.
  EXPECT_EQ(recommended({candidate({0.05, 0.06}, 0.5), candidate({0.01, 0.01}, 0.9)}, 1), 0U);
}

TEST(WaterScores, MeanHasAnInterval) {
  const MeanScore mean = meanOf({1, 2, 3, 4, std::nan("")});
  EXPECT_EQ(mean.count, 4U);
  EXPECT_DOUBLE_EQ(mean.mean, 2.5);
  EXPECT_NEAR(mean.half_width, 1.96 * std::sqrt(5.0 / 3 / 4), 1e-12);
}

TEST(Jpeg, KnowsAFilesQuality) {
  const auto folder = test::scratchFolder();
  const cv::Mat image(48, 64, CV_8UC3, cv::Scalar(30, 90, 160));
  for (const int quality : {40, 60, 75, 90}) {
    const auto file = folder / "image.jpg";
    cv::imwrite(file.string(), image, {cv::IMWRITE_JPEG_QUALITY, quality});
    ASSERT_TRUE(jpegQuality(file));
    EXPECT_NEAR(*jpegQuality(file), quality, 1);
  }
  cv::imwrite((folder / "image.png").string(), image);
  EXPECT_FALSE(jpegQuality(folder / "image.png"));
}

TEST(WaterStudy, WritesAWaterThatReadsBack) {
  const auto folder = test::scratchFolder();
  const Environment water = readEnvironment(test::kConfig / "water_turbid.yaml");
  writeTextFile(folder / "water.yaml", formatEnvironment(water, "two\nlines"));
  EXPECT_TRUE(waterParameters(readEnvironment(folder / "water.yaml")).isApprox(waterParameters(water), 1e-5));
}

}  // namespace
}  // namespace fathom
