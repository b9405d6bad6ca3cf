// Specks: as many of each class are counted as a known density of flakes makes in the volumes that are
// stated, and none where there are none.
#include "observables/specks.h"

#include <gtest/gtest.h>

#include "core/chi_square.h"
#include "imaging/image_model.h"
#include "support/sanitized.h"
#include "support/shipped.h"

namespace fathom {
namespace {

/// A wall across the line of sight, as the camera reads it.
struct Wall {
  const char* name;
  double albedo, z_m;
  const char* water;
  double fall = 0.1;        ///< of the light, from the middle to a corner
  bool in_pieces = false;   ///< every second square of 40 px is masked out
  bool two_labels = false;  ///< left and right, though they are one surface
};

class SpeckCamera {
 public:
  explicit SpeckCamera(const Wall& wall)
      : wall_(wall),
        environment_(readEnvironment(test::kConfig / wall.water)),
        model_(sheet_, environment_.water),
        size_(sheet_.model.width_px, sheet_.model.height_px),
        z_m_(size_, CV_32FC1, cv::Scalar(wall.z_m)),
        labels_(size_, CV_32SC1, cv::Scalar(0)),
        mask_(size_, CV_8UC1, cv::Scalar(255)) {
    for (int v = 0; v < size_.height; ++v)
      for (int u = 0; u < size_.width; ++u) {
        if (wall.in_pieces && (u / 40 + v / 40) % 2 == 0) mask_.at<std::uint8_t>(v, u) = 0;
        if (wall.two_labels && u > 300) labels_.at<int>(v, u) = 5;
      }
  }

  /// Of some images: the specks of each class, and the volumes that they come of.
  std::pair<BySpeckClass, SpeckVolumes> count(double per_m3, int images) const {
    std::pair<BySpeckClass, SpeckVolumes> all{BySpeckClass::Zero(), {}};
    for (int i = 0; i < images; ++i) {
      const SpeckCount one = count(per_m3, static_cast<std::uint64_t>(i));
      all.first += one.specks;
      all.second += volumesOf(one.cells, environment_);
    }
    return all;
  }

 private:
  SpeckCount count(double per_m3, std::uint64_t seed) const {
    cv::Mat light = plain();
    drawSnow(light, z_m_, sheet_.model, environment_, per_m3, Random::stream(seed, 1));
    Random noise = Random::stream(seed, 2);
    const cv::Mat image = model_.expose(light, &noise);
    return countSpecks({radianceOf(image, sheet_), mask_, labels_, z_m_}, sheet_, sheet_.model);
  }

  /// Brighter in the middle: or else rounding would treat all pixels alike.
  cv::Mat plain() const {
    const Vector3d radiance = wall_.albedo * environment_.ambient;
    const cv::Mat scene(size_, CV_32FC3, cv::Scalar(radiance[0], radiance[1], radiance[2]));
    cv::Mat range_m;
    cv::divide(z_m_, cosinesOf(sheet_.model), range_m);
    cv::Mat light = model_.light(scene, range_m);
    for (int v = 0; v < size_.height; ++v)
      for (int u = 0; u < size_.width; ++u) {
        const double off_middle = std::hypot(u - 320, v - 240) / 400;
        light.at<cv::Vec3f>(v, u) *= static_cast<float>(1 - wall_.fall * off_middle * off_middle);
      }
    return light;
  }

  Wall wall_;
  CameraSheet sheet_ = *readVehicle(test::kRov).camera;
  Environment environment_;
  ImageModel model_;
  cv::Size size_;
  cv::Mat z_m_, labels_, mask_;
};

class SpecksOn : public testing::TestWithParam<Wall> {};

// By Poisson's law, with 4 % for what the volumes leave out: that a flake's pixels need not lie side by side,
// rounding, third flakes where two overlap. Sixteen times, and few specks scatter by more than chi-square has
// it.
TEST_P(SpecksOn, AreAsManyAsTheVolumesSay) {
  const SpeckCamera camera(GetParam());
  constexpr int kImages = test::kSanitized ? 2 : 8;
  for (const double per_m3 : {100.0, 400.0}) {
    const auto [specks, volumes] = camera.count(per_m3, kImages);
    const auto expected = expectedSpecks(volumes, per_m3);
    double chi_square = 0;
    for (int k = 0; k < kSpeckClasses; ++k) {
      const double variance = expected[k] + std::pow(0.04 * expected[k], 2);
      chi_square += std::pow(specks[k] - expected[k], 2) / variance;
    }
    EXPECT_LT(chi_square, chiSquareQuantile(kSpeckClasses, 0.9999))
        << per_m3 << ": " << specks.transpose() << " for " << expected.transpose();
    EXPECT_GT(expected.sum(), 12 * kImages);
  }
}

TEST_P(SpecksOn, AreNoneWithoutFlakes) {
  const SpeckCamera camera(GetParam());
  EXPECT_EQ(camera.count(0, 3).first.sum(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Specks, SpecksOn,
    testing::Values(Wall{"white", 0.85, 2, "water_clear.yaml"}, Wall{"black", 0.04, 2, "water_clear.yaml"},
                    Wall{"gray_nearby", 0.3, 0.8, "water_moderate.yaml"},
                    Wall{"white_in_turbid_water", 0.85, 1.5, "water_turbid.yaml"},
                    Wall{"black_in_turbid_water", 0.04, 2, "water_turbid.yaml"},
                    Wall{"white_unevenly_lit", 0.85, 1, "water_clear.yaml", 0.4},
                    Wall{"white_in_pieces", 0.85, 2, "water_clear.yaml", 0.1, true},
                    Wall{"black_of_two_labels", 0.04, 1.5, "water_moderate.yaml", 0.1, false, true}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Specks, NothingIsCountedWhereNothingIsLookedAt) {
  const CameraSheet sheet = *readVehicle(test::kRov).camera;
  const cv::Size size(sheet.model.width_px, sheet.model.height_px);
  const cv::Mat light(size, CV_32FC3, cv::Scalar::all(0.5)), z_m(size, CV_32FC1, cv::Scalar(2));
  const cv::Mat everywhere(size, CV_8UC1, cv::Scalar(255)), nowhere(size, CV_8UC1, cv::Scalar(0));
  const cv::Mat labels(size, CV_32SC1, cv::Scalar(0)), unlabelled(size, CV_32SC1, cv::Scalar(-1));
  for (const SpeckImage& image :
       {SpeckImage{light, nowhere, labels, z_m}, SpeckImage{light, everywhere, unlabelled, z_m}}) {
    const SpeckCount count = countSpecks(image, sheet, sheet.model);
    EXPECT_EQ(count.specks.sum(), 0);
    EXPECT_TRUE(count.cells.empty());
  }
}

}  // namespace
}  // namespace fathom
