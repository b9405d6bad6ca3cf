// A recording with known water: simulated, its markers found, its panel rendered at the poses they tell, and
// the water fitted to what differs.
#include <gtest/gtest.h>

#include "environment/water_study.h"
#include "support/shared_data.h"
#include "support/water_recordings.h"

namespace fathom {
namespace {

TEST(WaterRecording, TellsItsWater) {
  const auto recording = test::simulateApproach(test::scratchFolder(), "water_moderate.yaml");
  const PosedImages images =
      posedImages(recording.rawlog, {}, readPanelMaps(test::kDexrovMap), test::silDetection());
  ASSERT_GT(images.posed.size(), 15U);
  const PairMaker maker(test::silWorld(), {}, test::silDetection());
  std::vector<std::size_t> all(images.posed.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const SynchronizedImages synchronized = synchronize(images.posed, all, maker);
  EXPECT_GE(synchronized.images.size(), 15U);  // from afar, cells of 320 x 240 px are too small
  WaterFitOptions options;
  options.start = readEnvironment(test::kConfig / "water_clear.yaml");
  const WaterFit fit = fitWater(synchronized.patches, synchronized.images.size(), options);
  ASSERT_TRUE(fit.solved) << fit.why_not;
  const Vector9d truth = waterParameters(readEnvironment(test::kConfig / "water_moderate.yaml"));
  const Vector9d found = waterParameters(fit.environment), sigma = fit.sigma();
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(found[i] / truth[i], 1, 0.02) << i;
    EXPECT_LT(std::abs(found[i] - truth[i]) / sigma[i], 4) << i;
  }
  EXPECT_FALSE(fit.gain_fitted);
  EXPECT_TRUE(fit.warnings.empty()) << fit.warnings.front();

  // Images paired with the poses of others are told, one by one.
  std::vector<PosedImage> confused = images.posed;
  for (std::size_t i = 0; i < confused.size(); ++i)
    confused[i].T_odom_robot = images.posed[(i + confused.size() / 2) % confused.size()].T_odom_robot;
  const SynchronizedImages wrong = synchronize(confused, all, maker);
  EXPECT_TRUE(wrong.images.empty());
  EXPECT_NE(wrong.rejected.front().why.find("the pose is not this image's"), std::string::npos)
      << wrong.rejected.front().why;
}

}  // namespace
}  // namespace fathom
