// Patches of an image whose albedo, distance and water are known, and images that have none.
#include <gtest/gtest.h>

#include "image_files/bayer.h"
#include "imaging/image_model.h"
#include "observables/patches.h"
#include "support/shipped.h"

namespace fathom {
namespace {

constexpr float kFar_m = 3, kNear_m = 2;

CameraSheet shippedSheet() { return *readVehicle(test::kRov).camera; }

/// A wall before the camera: white on its left, black on its right; the upper half is nearer.
View wall(const CameraModel& camera) {
  const cv::Size size(camera.width_px, camera.height_px);
  View view{cv::Mat(size, CV_32FC3, cv::Scalar::all(0.85)), cv::Mat(size, CV_32FC1, cv::Scalar(kFar_m))};
  view.radiance.colRange(size.width / 2, size.width).setTo(cv::Scalar::all(0.04));
  view.range_m.rowRange(0, size.height / 2).setTo(kNear_m);
  return view;
}

cv::Mat everywhere(const View& view) { return {view.range_m.size(), CV_8UC1, cv::Scalar(255)}; }

struct WallScene {
  CameraSheet sheet = shippedSheet();
  View clean = wall(sheet.model);
  cv::Mat z_per_range = cosinesOf(sheet.model);
  Environment water = readEnvironment(test::kConfig / "water_moderate.yaml");
  cv::Mat image = seenThrough(water);

  cv::Mat seenThrough(const Environment& environment) const {
    const ImageModel model(sheet, environment.water);
    const Vector3d& ambient = environment.ambient;
    const cv::Mat scene = clean.radiance.mul(cv::Scalar(ambient[0], ambient[1], ambient[2]));
    Random noise = Random::stream(1, 0);
    return model.expose(model.light(scene, clean.range_m), &noise);
  }

  PatchSet patches() const {
    return patchesOf(image, clean, everywhere(clean), z_per_range, squareLabels(image.size()), sheet);
  }
};

TEST(WaterPatches, AreWhatTheWaterMakesOfTheWall) {
  const WallScene scene;
  const PatchSet set = scene.patches();
  EXPECT_EQ(set.why_not, "");
  EXPECT_GT(set.patches.size(), 1000U);
  for (const Patch& patch : set.patches) {
    EXPECT_LE(patch.z_m, patch.range_m);
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(std::isfinite(patch.sigma[c]));
      const double passed = std::exp(-scene.water.water.attenuation_per_m[c] * patch.z_m);
      const double expected =
          patch.albedo[c] * scene.water.ambient[c] * passed + (1 - passed) * scene.water.water.veil[c];
      // Rounding shifts a mean where noise is less than half a digital number: up to a tenth of one here.
      EXPECT_NEAR(patch.radiance[c], expected, 5 * patch.sigma[c] + 0.1 / 255);
    }
  }
}

/// Mean square of what patches are off by, in sigmas, where it gets darker evenly with range and by its
/// paint.
double meanSquareOff(BayerPattern bayer) {
  constexpr int kSide_px = 64;
  WallScene scene;
  scene.sheet.model.bayer = bayer;
  for (int v = 0; v < scene.clean.range_m.rows; ++v)
    for (int u = 0; u < scene.clean.range_m.cols; ++u) {
      const float across = static_cast<float>(u) / 640, down = static_cast<float>(v) / 480;
      scene.clean.radiance.at<cv::Vec3f>(v, u) = cv::Vec3f::all(0.3f + 0.5f * across);
      scene.clean.range_m.at<float>(v, u) = (kNear_m + down) / scene.z_per_range.at<float>(v, u);
    }
  scene.image = demosaiced(mosaic(scene.seenThrough(scene.water), bayer), bayer);
  const PatchSet set = patchesOf(scene.image, scene.clean, everywhere(scene.clean), scene.z_per_range,
                                 squareLabels(scene.image.size(), kSide_px), scene.sheet);
  EXPECT_EQ(set.why_not, "");
  EXPECT_GT(set.patches.size(), 50U);
  double squares = 0;
  for (const Patch& patch : set.patches) {
    const Eigen::Array3d passed = (-patch.z_m * scene.water.water.attenuation_per_m.array()).exp();
    const Eigen::Array3d expected = patch.albedo.array() * scene.water.ambient.array() * passed +
                                    (1 - passed) * scene.water.water.veil.array();
    squares += ((patch.radiance.array() - expected) / patch.sigma.array()).square().mean();
  }
  return squares / static_cast<double>(set.patches.size());
}

// Only the sensor's noise is left. (Sigmas that counted what varies were five times too large here.) Of more
// than 150 numbers the mean square is within 0.3 of one but once in a hundred times.
TEST(WaterPatches, ScatterByTheirSigmaWhateverVariesWithinThem) {
  EXPECT_NEAR(meanSquareOff(BayerPattern::none), 1, 0.3);
}

// Of a raw image only those pixels tell of a colour that measure it: with sigmas of all it were more.
TEST(WaterPatches, OfARawImageScatterByTheirSigmaToo) {
  EXPECT_NEAR(meanSquareOff(BayerPattern::rggb), 1, 0.3);
  EXPECT_NEAR(meanSquareOff(BayerPattern::gbrg), 1, 0.3);
}

TEST(WaterPatches, KeepOffEdges) {
  const WallScene scene;
  for (const Patch& patch : scene.patches().patches) {
    EXPECT_TRUE(std::abs(patch.albedo[0] - 0.85) < 1e-5 || std::abs(patch.albedo[0] - 0.04) < 1e-5);
  }
}

TEST(WaterPatches, DoNotCountWhereSaturated) {
  WallScene scene;
  scene.image.at<cv::Vec3b>(40, 40) = cv::Vec3b(10, 20, 255);  // one red pixel
  const PatchSet set = scene.patches();
  EXPECT_EQ(set.why_not, "");
  EXPECT_EQ(set.saturated, 1U);
  int excluded = 0;
  for (const Patch& patch : set.patches) excluded += std::isfinite(patch.sigma[0]) ? 0 : 1;
  EXPECT_EQ(excluded, 1);
}

TEST(WaterPatches, RefuseAnOverexposedImage) {
  WallScene scene;
  scene.image.setTo(cv::Scalar::all(255));
  EXPECT_EQ(scene.patches().why_not, "is overexposed: 100 % of the panel is at full scale");
}

TEST(WaterPatches, RefuseAnEmptyMask) {
  const WallScene scene;
  const cv::Mat nowhere = cv::Mat::zeros(scene.clean.range_m.size(), CV_8UC1);
  const PatchSet set = patchesOf(scene.image, scene.clean, nowhere, scene.z_per_range,
                                 squareLabels(scene.image.size()), scene.sheet);
  EXPECT_TRUE(set.patches.empty());
  EXPECT_EQ(set.why_not, "no part of a panel that is large enough is in view of its pose (0 patches)");
}

TEST(WaterPatches, RefuseAnotherPose) {
  WallScene scene;
  cv::flip(scene.image, scene.image, 1);  // white is where the pose has black
  EXPECT_NE(scene.patches().why_not.find("does not show the panel where its pose puts it"),
            std::string::npos);
}

TEST(WaterPatches, RefuseAnotherSize) {
  WallScene scene;
  scene.image = scene.image.colRange(0, 320).clone();
  EXPECT_EQ(scene.patches().why_not, "is of 320 x 480 pixels, its rendering of 640 x 480");
}

}  // namespace
}  // namespace fathom
