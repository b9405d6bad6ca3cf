// Where an image shows open water.
#include "observables/open_water.h"

#include <gtest/gtest.h>

#include "support/shipped.h"

namespace fathom {
namespace {

/// Looks level along odom's x, before something that hides the picture's left half; the reading grows to the
/// right.
class OpenWater : public testing::Test {
 protected:
  OpenWater() {
    const cv::Size size(camera_.width_px, camera_.height_px);
    pair_.recorded = cv::Mat(size, CV_8UC3);
    pair_.clean.range_m = cv::Mat(size, CV_32FC1, cv::Scalar(std::numeric_limits<float>::infinity()));
    pair_.clean.range_m.colRange(0, size.width / 2).setTo(2.0);
    for (int u = 0; u < size.width; ++u) pair_.recorded.col(u).setTo(cv::Scalar::all(40 + u / 8));
    level_.col(0) = -Vector3d::UnitY();
    level_.col(1) = -Vector3d::UnitZ();
    level_.col(2) = Vector3d::UnitX();
  }

  std::vector<Patch> seen(double pitch_up_rad = 0) const {
    return openWaterOf(pair_, raysOf(camera_), level_ * expSO3<double>(Vector3d(pitch_up_rad, 0, 0)), sheet_);
  }

  CameraSheet sheet_ = *readVehicle(test::kRov).camera;
  CameraModel camera_ = sheet_.model;
  CleanPair pair_;
  Matrix3d level_;
};

TEST_F(OpenWater, IsBesideWhatIsThereAndWellAboveTheHorizon) {
  const std::vector<Patch> patches = seen();
  // Of three rows of cells the upper one, of two the part that rises by 5 degrees.
  ASSERT_EQ(patches.size(), 4U);
  const double horizon_px = camera_.cy_px, rise_px = camera_.fy_px * std::tan(radians(5));
  for (const Patch& patch : patches) {
    EXPECT_GT(patch.pixel.x(), 0.5 * camera_.width_px);
    EXPECT_LT(patch.pixel.y() + std::sqrt(patch.pixel_covariance(1, 1)), horizon_px - rise_px);
    EXPECT_NEAR(patch.z_m, kOpenWater_m, 1e-3 * kOpenWater_m);
    EXPECT_NEAR(patch.image_radius, camera_.idealAt(patch.pixel).norm(), 0.02);
    EXPECT_EQ(patch.albedo, Vector3d::Zero());
    // Numbers that grow by one every eight pixels: half of one less than at the middle.
    EXPECT_NEAR(patch.radiance[0] * 255, 40 + patch.pixel.x() / 8 - 0.5, 0.6);
  }
}

TEST_F(OpenWater, IsWhereverTheCameraLooksUp) {
  EXPECT_EQ(seen(radians(60)).size(), 6U);
  EXPECT_TRUE(seen(radians(-60)).empty());
}

}  // namespace
}  // namespace fathom
