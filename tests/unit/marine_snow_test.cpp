// Flakes of marine snow: where they are, and what one does to an image.
#include "imaging/marine_snow.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "sensors/vehicle.h"
#include "simulation/camera_studio.h"
#include "support/shipped.h"

namespace fathom {
namespace {

Environment clear() { return readEnvironment(test::kConfig / "water_clear.yaml"); }
CameraModel shippedCamera() { return readVehicle(test::kRov).camera->model; }

cv::Mat uniform(const CameraModel& camera, int type, double value) {
  return {camera.height_px, camera.width_px, type, cv::Scalar::all(value)};
}

// By counting: a pixel is cut into 400 x 400.
TEST(MarineSnow, CoverageIsTheAreaThatDiscAndPixelShare) {
  constexpr int kFine = 400;
  Random random(1);
  for (int round = 0; round < 60; ++round) {
    const double radius = 0.1 * std::exp(random.uniform(0, 3.5));
    const Vector2d centre(random.uniform(-2, 2), random.uniform(-2, 2));
    int within = 0;
    for (int i = 0; i < kFine * kFine; ++i) {
      const Vector2d point((i % kFine + 0.5) / kFine - 0.5, (i / kFine + 0.5) / kFine - 0.5);
      within += (point - centre).norm() < radius ? 1 : 0;
    }
    EXPECT_NEAR(coveredShare({0, 0}, centre, radius), within / std::pow(kFine, 2), 1e-3) << radius;
  }
}

TEST(MarineSnow, CoverageSumsUpToTheDisc) {
  Random random(2);
  for (const double radius : {0.01, 0.3, 0.5, 1.0, 2.7, 6.0}) {
    const Vector2d centre(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
    double sum = 0;
    for (int v = -8; v <= 8; ++v)
      for (int u = -8; u <= 8; ++u) sum += coveredShare(Vector2d(u, v), centre, radius);
    EXPECT_NEAR(sum, std::numbers::pi * radius * radius, 1e-9 * radius);
  }
}

// Its area in the image, not only at the middle of one that bends lines.
TEST(MarineSnow, FocalLengthIsOfAreas) {
  const CameraModel camera = shippedCamera();
  for (const Vector2d& ideal : {Vector2d(0, 0), Vector2d(0.3, -0.2), Vector2d(-0.5, 0.35)}) {
    constexpr double h = 1e-3;
    const auto pixel = [&](double x, double y) {
      return Vector2d(camera.project<double>((ideal + Vector2d(x, y)).homogeneous()));
    };
    const Vector2d diagonal = pixel(h, h) - pixel(-h, -h), other = pixel(-h, h) - pixel(h, -h);
    const double area = 0.5 * std::abs(diagonal.x() * other.y() - diagonal.y() * other.x());
    EXPECT_NEAR(focalAt(ideal, camera), std::sqrt(area) / (2 * h), 0.01);
  }
}

// In black water that takes no light a flake adds what it covers times its own light, so all that is added
// tells how many there are: their areas go as 1/z², their number as z².
TEST(MarineSnow, AsManyAreDrawnAsTheVolumeHolds) {
  const CameraModel camera = shippedCamera();
  Environment vacuum;
  constexpr double kDensity = 200, kWall_m = 2;
  constexpr int kImages = 50;
  double added = 0;
  for (int i = 0; i < kImages; ++i) {
    cv::Mat light = uniform(camera, CV_32FC3, 0);
    drawSnow(light, uniform(camera, CV_32FC1, kWall_m), camera, vacuum, kDensity,
             Random::stream(3, static_cast<std::uint64_t>(i)));
    added += cv::sum(light)[1] / kFlakeReflectance;
  }
  double solid = 0;  // area of ideal image coordinates times focal length squared: about the image's
  for (int v = 0; v < camera.height_px; v += 20)
    for (int u = 0; u < camera.width_px; u += 20) solid += 400;
  const double radius_m = kFlakeDiameter_m / 2;
  const double expected =
      kImages * kDensity * std::numbers::pi * radius_m * radius_m * (kWall_m - kNearestFlake_m) * solid;
  // Of a flake's area the mean square is that of 1/z^4 over z²: few near ones make most of the scatter.
  const double scatter = std::sqrt(kImages * kDensity * std::pow(std::numbers::pi * radius_m * radius_m, 2) *
                                   std::pow(camera.fx_px, 2) * solid * (1 / kNearestFlake_m - 1 / kWall_m));
  EXPECT_NEAR(added, expected, 4 * scatter + 0.005 * expected);  // and some hide others
  EXPECT_LT(scatter, 0.03 * expected);
}

// The whole chain for one flake, with its place found from the image that it makes.
TEST(MarineSnow, OneFlakeIsItsOwnLightAndTheVeilBeforeIt) {
  const CameraModel camera = shippedCamera();
  const Environment environment = clear();
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 300 && seen < 3; ++seed) {
    cv::Mat light = uniform(camera, CV_32FC3, 0.25);
    drawSnow(light, uniform(camera, CV_32FC1, 0.4), camera, environment, 60, Random(seed));
    cv::Mat off = cv::abs(light - cv::Scalar::all(0.25)), one;
    cv::extractChannel(off, one, 2);
    double largest = 0;
    cv::Point where;
    cv::minMaxLoc(one, nullptr, &largest, nullptr, &where);
    if (largest == 0 || !cv::Rect(20, 20, 600, 440).contains(where)) continue;
    cv::Mat around = light({where.x - 12, where.y - 12, 25, 25});
    if (cv::countNonZero(one) != cv::countNonZero(one({where.x - 12, where.y - 12, 25, 25}))) continue;
    ++seen;
    // Fully covered pixels show the flake alone: of red and blue, two unknowns (range), one agreement.
    const cv::Vec3f flake = light.at<cv::Vec3f>(where);
    double z_m = kNearestFlake_m;
    while (z_m < 0.4 && std::abs(flakeLight(z_m, environment)[0] - flake[0]) > 2e-4) z_m += 1e-4;
    ASSERT_LT(z_m, 0.4);
    for (int c = 0; c < 3; ++c) {
      const double passed = std::exp(-environment.water.attenuation_per_m[c] * z_m);
      const double expected =
          kFlakeReflectance * environment.ambient[c] * passed + (1 - passed) * environment.water.veil[c];
      EXPECT_NEAR(flake[c], expected, 1e-3);
    }
    const double area = cv::sum(around - cv::Scalar::all(0.25))[2] / (flake[2] - 0.25);
    const double radius_px = camera.fx_px * kFlakeDiameter_m / 2 / z_m;
    EXPECT_NEAR(area, std::numbers::pi * radius_px * radius_px, 0.12 * area);  // as well as z is known
  }
  EXPECT_EQ(seen, 3);
}

TEST(MarineSnow, IsTheSameForTheSameNumbersAndOtherForOthers) {
  const CameraModel camera = shippedCamera();
  const auto drawn = [&](std::uint64_t seed) {
    cv::Mat light = uniform(camera, CV_32FC3, 0.1);
    drawSnow(light, uniform(camera, CV_32FC1, std::numeric_limits<float>::infinity()), camera, clear(), 50,
             Random(seed));
    return light;
  };
  EXPECT_EQ(cv::norm(drawn(1), drawn(1), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(drawn(1), drawn(2), cv::NORM_INF), 0.1);
}

TEST(MarineSnow, NothingIsDrawnBehindASurfaceNorWithoutParticles) {
  const CameraModel camera = shippedCamera();
  cv::Mat light = uniform(camera, CV_32FC3, 0.1), z_m = uniform(camera, CV_32FC1, 3);
  z_m.colRange(0, 320).setTo(kNearestFlake_m);
  drawSnow(light, z_m, camera, clear(), 300, Random(1));
  EXPECT_EQ(
      cv::norm(light.colRange(0, 320), cv::Mat(480, 320, CV_32FC3, cv::Scalar::all(0.1F)), cv::NORM_INF), 0);
  EXPECT_GT(
      cv::norm(light.colRange(320, 640), cv::Mat(480, 320, CV_32FC3, cv::Scalar::all(0.1F)), cv::NORM_INF),
      0.1);
  cv::Mat none = uniform(camera, CV_32FC3, 0.1);
  drawSnow(none, z_m, camera, clear(), 0, Random(1));
  EXPECT_EQ(cv::norm(none, uniform(camera, CV_32FC3, 0.1), cv::NORM_INF), 0);
}

// Where contrast is without end every flake is seen: the volume is the pixel's share of the view.
TEST(MarineSnow, AllOfTheVolumeIsVisibleWithoutNoise) {
  const Backdrop backdrop{Vector3d::Zero(), Vector3d::Constant(1e-6), 2, 555};
  const double volume_m3 = visibleVolume(backdrop, Environment{}).sum() * 555 * 555;
  EXPECT_NEAR(volume_m3, (std::pow(2, 3) - std::pow(kNearestFlake_m, 3)) / 3, 0.005);
}

TEST(MarineSnow, NothingIsVisibleThatLooksLikeWhatIsBehindIt) {
  const Environment vacuum;  // a flake is as bright anywhere
  const Backdrop backdrop{Vector3d::Constant(kFlakeReflectance), Vector3d::Constant(0.002), 2, 555};
  EXPECT_EQ(visibleVolume(backdrop, vacuum).sum(), 0);
  Backdrop one_colour = backdrop;
  one_colour.light[1] = 0.1;
  EXPECT_GT(visibleVolume(one_colour, vacuum).sum(), 0);
  one_colour.sigma[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(visibleVolume(one_colour, vacuum).sum(), 0);
}

// Through the camera's whole model, in endless water: by seed and stamp, and only while the effect is on.
TEST(MarineSnow, IsInTheImagesOfTheStudio) {
  const Vehicle vehicle = readVehicle(test::kRov);
  EffectParameters<double> effects;
  effects.add<MarineSnow>({30.0});
  effects.active_s[kEffectIndex<MarineSnow>] = {10, 20};
  const CameraStudio studio({{}, {}, clear()}, *vehicle.camera, vehicle.lamps, effects);
  const auto image = [&](double t_s, std::uint64_t seed) {
    CameraShot shot{{}, trueCamera(vehicle.camera->model, {}, {}, effects, t_s), t_s};
    shot.particle_seed = seed;
    return studio.image(shot, nullptr);
  };
  const cv::Mat plain = image(5, 1), snow = image(15, 1);
  EXPECT_EQ(cv::norm(plain, image(25, 2), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(snow, image(15, 1), cv::NORM_INF), 0);
  for (const cv::Mat& other : {plain, image(15, 2), image(16, 1)})
    EXPECT_GT(cv::norm(snow, other, cv::NORM_INF), 10);
}

}  // namespace
}  // namespace fathom
