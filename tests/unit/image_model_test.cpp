#include "imaging/image_model.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {

constexpr float kNothingHit = std::numeric_limits<float>::infinity();
const Water kTurbid{{1.1, 0.68, 0.74}, {0.05, 0.24, 0.22}};

CameraSheet sheetOf(int width_px, int height_px) {
  CameraSheet sheet;
  sheet.model = {width_px,
                 height_px,
                 0.8 * width_px,
                 0.81 * width_px,
                 0.51 * width_px,
                 0.47 * height_px,
                 -0.04,
                 -0.02,
                 -0.0002,
                 0.0008,
                 0};
  return sheet;
}

struct Rendered {
  cv::Mat radiance, range_m;
};

/// Any scene: radiances from 0 to 1.2, ranges from 0.3 to 60 m, a tenth of the pixels hit nothing.
Rendered randomView(const CameraSheet& sheet, std::uint64_t seed) {
  Random random(seed);
  Rendered view{cv::Mat(sheet.model.height_px, sheet.model.width_px, CV_32FC3),
                cv::Mat(sheet.model.height_px, sheet.model.width_px, CV_32FC1)};
  for (int v = 0; v < view.range_m.rows; ++v)
    for (int u = 0; u < view.range_m.cols; ++u) {
      const bool hit = random.uniform() > 0.1;
      view.range_m.at<float>(v, u) =
          hit ? static_cast<float>(0.3 * std::pow(200, random.uniform())) : kNothingHit;
      for (int c = 0; c < 3; ++c)
        view.radiance.at<cv::Vec3f>(v, u)[c] = hit ? static_cast<float>(random.uniform(0, 1.2)) : 0.0F;
    }
  return view;
}

cv::Mat uniformLight(const CameraSheet& sheet, double radiance) {
  return {sheet.model.height_px, sheet.model.width_px, CV_32FC3, cv::Scalar::all(radiance)};
}

// The equation written out again, in double, with the line of sight from the camera model.
TEST(CosinesOf, AreThoseOfPointsFoundForwards) {
  const CameraModel camera = readVehicle(test::kRov).camera->model;
  const cv::Mat cosines = cosinesOf(camera);
  Random random(1);
  for (int n = 0; n < 50; ++n) {
    const Vector3d along = Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4), 1).normalized();
    const Vector2d pixel = camera.project(along);
    const float cosine =
        cosines.at<float>(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
    EXPECT_NEAR(cosine, along.z(), 0.0007);  // half a pixel is 0.5/555 rad, at most 35 degrees off axis
  }
}

TEST(ImageModel, LightIsThePapersEquation) {
  const CameraSheet sheet = sheetOf(160, 120);
  const Rendered view = randomView(sheet, 3);
  const cv::Mat light = ImageModel(sheet, kTurbid).light(view.radiance, view.range_m);
  double largest = 0;
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u) {
      const Vector2d ideal = sheet.model.idealAt({u, v});
      const double z_m = view.range_m.at<float>(v, u) / std::hypot(ideal.x(), ideal.y(), 1.0);
      for (int c = 0; c < 3; ++c) {
        const double passed = std::isinf(z_m) ? 0.0 : std::exp(-kTurbid.attenuation_per_m[c] * z_m);
        const double expected =
            view.radiance.at<cv::Vec3f>(v, u)[c] * passed + (1 - passed) * kTurbid.veil[c];
        largest = std::max(largest, std::abs(light.at<cv::Vec3f>(v, u)[c] - expected));
      }
    }
  EXPECT_LT(largest,
            4e-7);  // float's resolution at 1 is 6e-8, a few operations, and exp()'s 3e-7 times depth
}

TEST(ImageModel, WhereNothingIsHitThereIsTheVeilEvenInWaterThatPassesAll) {
  const CameraSheet sheet = sheetOf(16, 12);
  const cv::Mat nothing(12, 16, CV_32FC1, cv::Scalar(kNothingHit));
  Water clear = kTurbid;
  clear.attenuation_per_m.setZero();
  for (const Water& water : {kTurbid, clear}) {
    const cv::Mat light = ImageModel(sheet, water).light(uniformLight(sheet, 0), nothing);
    for (int c = 0; c < 3; ++c)
      EXPECT_FLOAT_EQ(light.at<cv::Vec3f>(5, 7)[c], static_cast<float>(water.veil[c]));
  }
}

// Whole images are approximated to 3e-7 of the light.
TEST(ImageModel, ImagesAreThePerPixelModel) {
  const CameraSheet sheet = sheetOf(64, 48);
  const Rendered view = randomView(sheet, 4);
  const cv::Mat light = ImageModel(sheet, kTurbid).light(view.radiance, view.range_m);
  for (int v = 0; v < light.rows; ++v)
    for (int u = 0; u < light.cols; ++u) {
      const auto& scene = view.radiance.at<cv::Vec3f>(v, u);
      const double range = view.range_m.at<float>(v, u), cosine = sheet.model.rayAt({u, v}).z();
      const Vector3d expected =
          predictLight<double>(Vector3d(scene[0], scene[1], scene[2]), range * cosine, range, kTurbid, {});
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(light.at<cv::Vec3f>(v, u)[c], expected[c], 4e-7);
    }
}

TEST(ImageModel, PerPixelModelIsDifferentiable) {
  using Jet = ceres::Jet<double, 1>;
  WaterColumn<Jet> water{kTurbid.attenuation_per_m.cast<Jet>(), kTurbid.veil.cast<Jet>()};
  water.attenuation_per_m[1].v[0] = 1;
  const Vector3<Jet> scene(Jet(0.5), Jet(0.7), Jet(0.2));
  const auto light = predictLight<Jet>(scene, Jet(2.0), Jet(2.2), water, {});
  // d/da [i e^{-az} + (1 - e^{-az}) b] = -z e^{-az} (i - b)
  EXPECT_NEAR(light[1].v[0], -2 * std::exp(-2 * 0.68) * (0.7 - 0.24), 1e-15);
  EXPECT_EQ(light[0].v[0], 0);
  const ResponseCurve<Jet> curve{Jet(1.2, 0)};
  EXPECT_NEAR(predictReading(Jet(0.3), {}, curve, 1).v[0], std::log(0.3) * std::pow(0.3, 1.2), 1e-15);
}

// At its peak a plume is water of that much more attenuation; five widths away there is e^-12.5 of it.
TEST(ImageModel, APlumeIsMoreTurbidWaterForAWhile) {
  const CameraSheet sheet = sheetOf(16, 12);
  const Rendered view = randomView(sheet, 5);
  EffectParameters<double> plume;
  plume.add<TurbidityPlume>({0.4, 30.0, std::log(0.2)});  // two seconds wide
  const ImageModel model(sheet, kTurbid, plume);
  Water peak = kTurbid;
  peak.attenuation_per_m.array() += 0.4;
  const auto differs = [&](double t_s, const Water& water) {
    return cv::norm(model.light(view.radiance, view.range_m, t_s),
                    ImageModel(sheet, water).light(view.radiance, view.range_m), cv::NORM_INF);
  };
  EXPECT_LT(differs(30, peak), 1e-6);
  EXPECT_LT(differs(20, kTurbid), 1e-5);
  EXPECT_GT(differs(31, kTurbid), 0.01);
  EXPECT_GT(differs(31, peak), 0.01);
}

// A cloud that drifts past in space: what it takes of the light is marched along the line of sight, step by
// step.
TEST(ImageModel, ACloudInSpaceTakesWhatIsOnTheWayThroughIt) {
  Random random(12);
  const WaterColumn<double> water{Vector3d::Constant(0.1), Vector3d::Zero()};
  for (int i = 0; i < 200; ++i) {
    const double size_m = random.uniform(0.3, 3), speed_m_s = random.uniform(0.02, 0.3), peak_per_m = 0.4;
    const double heading = random.uniform(-3, 3), peak_s = 30, t_s = random.uniform(20, 40);
    const Vector3d drift = speed_m_s * Vector3d(std::cos(heading), std::sin(heading), 0);
    const Vector3d across = Vector3d::UnitZ().cross(drift.normalized());
    const double across_m = random.uniform(-2, 2), up_m = random.uniform(-2, 2);
    const Vector3d middle = across_m * across + up_m * Vector3d::UnitZ() + (t_s - peak_s) * drift;

    const SightInScene<double> sight{random.normals(3, 1), Vector3d(random.normals(3, 1)).normalized()};
    const double range_m = random.uniform(0.5, 6), z_m = random.uniform(0.8, 1) * range_m;
    constexpr int kSteps = 4000;
    double way_m = 0;  // as much at the cloud's middle takes as much
    for (int step = 0; step < kSteps; ++step) {
      const Vector3d there = sight.camera_m + (step + 0.5) / kSteps * range_m * sight.direction;
      way_m += range_m / kSteps * std::exp(-0.5 * (there - middle).squaredNorm() / (size_m * size_m));
    }
    const double depth = 0.1 * z_m + peak_per_m * way_m * z_m / range_m;

    EffectParameters<double> plume;
    const Vector3d per_m = drift.normalized() / size_m;
    plume.add<TurbidityPlume>({peak_per_m, peak_s, std::log(size_m / speed_m_s / 10), per_m.x(), per_m.y(),
                               across_m / size_m, up_m / size_m});
    const Vector3d light =
        predictLight<double>(Vector3d::Ones().eval(), z_m, range_m, water, plume, t_s, sight);
    EXPECT_NEAR(-std::log(light[1]), depth, 1e-6);  // steps of 1e-3 sizes: their square
  }
}

TEST(ImageModel, NumbersFollowTheResponse) {
  CameraSheet sheet = sheetOf(16, 12);
  const ImageModel linear(sheet, kTurbid);
  EXPECT_EQ(linear.expose(uniformLight(sheet, 0.5), nullptr).at<cv::Vec3b>(0, 0), cv::Vec3b(128, 128, 128));
  EXPECT_EQ(linear.expose(uniformLight(sheet, 1.7), nullptr).at<cv::Vec3b>(0, 0), cv::Vec3b(255, 255, 255));
  cv::Mat coloured = uniformLight(sheet, 0);
  coloured.setTo(cv::Scalar(0.2, 0.4, 0.6));  // red, green, blue
  EXPECT_EQ(linear.expose(coloured, nullptr).at<cv::Vec3b>(3, 3), cv::Vec3b(153, 102, 51));  // blue first
  sheet.response_gamma = 1.5;
  const ImageModel curved(sheet, kTurbid);
  EXPECT_EQ(curved.expose(uniformLight(sheet, 0.5), nullptr).at<cv::Vec3b>(0, 0)[0],
            std::lround(255 * std::pow(0.5, 1.5)));
  sheet.bits = 12;
  const cv::Mat deep = ImageModel(sheet, kTurbid).expose(uniformLight(sheet, 0.5), nullptr);
  ASSERT_EQ(deep.type(), CV_16UC3);
  EXPECT_EQ(deep.at<cv::Vec3w>(0, 0)[0], std::lround(4095 * std::pow(0.5, 1.5)));
}

// Whole images are exposed in float: to 1e-6 of full scale, which is a fifteenth of a number of 16 bits.
TEST(ImageModel, NumbersAreThePerPixelResponse) {
  CameraSheet sheet = sheetOf(48, 36);
  sheet.bits = 16;
  Random random(8);
  for (int round = 0; round < 20; ++round) {
    sheet.response_gamma = random.uniform(0.4, 1.2);
    EffectParameters<double> effects;
    effects.add<Vignetting>({random.uniform(-0.5, 1.0)});
    effects.add<Gamma>({random.uniform(-0.2, 0.2)});
    effects.add<DarkOffset>({random.uniform(-0.05, 0.05)});
    effects.add<WhiteBalance>({random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)});
    effects.add<ResponseBend>(
        {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)});
    effects.add<FlatField>({random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)});
    const cv::Mat light = randomView(sheet, 9).radiance;
    const cv::Mat numbers = ImageModel(sheet, kTurbid, effects).expose(light, nullptr);
    ResponseCurve<double> curve{sheet.response_gamma};
    applyEffects(effects, 0, curve);
    for (int v = 0; v < light.rows; ++v)
      for (int u = 0; u < light.cols; ++u) {
        const Vector2d ideal = sheet.model.idealAt({u, v});
        PixelResponse<double> response{ideal.norm(), ideal};
        applyEffects(effects, 0, response);
        for (int c = 0; c < 3; ++c) {
          const double expected = predictReading<double>(light.at<cv::Vec3f>(v, u)[c], response, curve, c);
          const int number = numbers.at<cv::Vec<std::uint16_t, 3>>(v, u)[2 - c];
          EXPECT_NEAR(number, 65535 * expected, 0.5 + 0.07) << u << " " << v;
        }
      }
  }
}

TEST(ImageModel, TheResponseIsInvertedAndItsSlopeToo) {
  using Jet = ceres::Jet<double, 1>;
  CameraSheet sheet;
  Random random(10);
  for (int i = 0; i < 100; ++i) {
    sheet.response_gamma = random.uniform(0.4, 1.3);
    const double radiance = random.uniform(0.01, 0.9);
    const PixelResponse<double> response{0.3, Vector2d::Zero(), Vector3d(9, random.uniform(0.5, 1.1), 9),
                                         Vector3d(9, random.uniform(-0.005, 0.05), 9)};
    const ResponseCurve<double> curve{sheet.response_gamma, Vector3d(9, random.uniform(-0.6, 0.6), 9)};
    const double reading = predictReading(radiance, response, curve, 1);
    if (reading < 1) {
      EXPECT_NEAR(radianceBehind(reading, response, curve, 1), radiance, 1e-12);
    }
    const double slope = predictReading<Jet>(Jet(radiance, 0), {}, {Jet(sheet.response_gamma)}, 1).v[0];
    EXPECT_NEAR(radianceStep(radiance, sheet) * 255 * slope, 1, 1e-12);
  }
}

TEST(ImageModel, RadianceComesBackFromTheNumbers) {
  for (const int bits : {8, 12}) {
    CameraSheet sheet = sheetOf(64, 48);
    sheet.bits = bits;
    sheet.response_gamma = 0.7;
    cv::Mat light(48, 64, CV_32FC3);
    cv::RNG random(7);
    random.fill(light, cv::RNG::UNIFORM, 0.0, 1.0);
    const cv::Mat back = radianceOf(ImageModel(sheet, kTurbid).expose(light, nullptr), sheet);
    // Half a number, through the steepest part of L = DN^(1/0.7).
    const double half_step = 0.5 / ((1 << bits) - 1) / 0.7;
    EXPECT_LT(cv::norm(back, light, cv::NORM_INF), half_step * 1.01 + 1e-6);
    EXPECT_GT(cv::norm(back, light, cv::NORM_INF), half_step * 0.5);
  }
}

/// Mean and variance of all numbers of an image, per channel.
void moments(const cv::Mat& image, cv::Scalar& mean, cv::Scalar& variance) {
  cv::Scalar sigma;
  cv::meanStdDev(image, mean, sigma);
  variance = sigma.mul(sigma);
}

TEST(ImageModel, NoiseHasTheVarianceOfTheory) {
  CameraSheet sheet = sheetOf(320, 240);
  sheet.full_well_e = 8000;
  sheet.read_noise_e = 40;
  for (const double radiance : {0.1, 0.35, 0.8}) {
    Random random(11);
    cv::Scalar mean, variance;
    moments(ImageModel(sheet, kTurbid).expose(uniformLight(sheet, radiance), &random), mean, variance);
    const double electrons = radiance * 8000;
    const double expected = std::pow(255.0 / 8000, 2) * (electrons + 40 * 40) + 1.0 / 12;  // and rounding
    const double n = 320 * 240;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(mean[c], 255 * radiance, 4 * std::sqrt(expected / n)) << radiance;
      EXPECT_NEAR(variance[c] / expected, 1, 4 * std::sqrt(2 / n)) << radiance;
    }
    EXPECT_NEAR(std::pow(255 * radianceSigma(radiance, sheet), 2), expected - 1.0 / 12, 1e-9);
  }
}

// With 16 bits and far from the clips the noise itself is seen: normal, and without correlation.
TEST(ImageModel, NoiseIsNormalAndWhite) {
  CameraSheet sheet = sheetOf(320, 240);
  sheet.bits = 16;
  Random random(12);
  const cv::Mat image = ImageModel(sheet, kTurbid).expose(uniformLight(sheet, 0.5), &random);
  std::vector<double> z;
  for (int v = 0; v < 240; ++v)
    for (int i = 0; i < 960; ++i)
      z.push_back((image.ptr<std::uint16_t>(v)[i] / 65535.0 - 0.5) / radianceSigma(0.5, sheet));
  double third = 0, fourth = 0, next = 0, next_channel = 0;
  int beyond_two = 0;
  for (std::size_t i = 3; i < z.size(); ++i) {
    third += std::pow(z[i], 3);
    fourth += std::pow(z[i], 4);
    next += z[i] * z[i - 3];
    next_channel += z[i] * z[i - 1];
    beyond_two += std::abs(z[i]) > 2 ? 1 : 0;
  }
  const auto n = static_cast<double>(z.size());
  EXPECT_NEAR(third / n, 0, 4 * std::sqrt(15 / n));
  EXPECT_NEAR(fourth / n, 3, 4 * std::sqrt(96 / n));
  EXPECT_NEAR(next / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(next_channel / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(beyond_two / n, 0.0455, 4 * std::sqrt(0.0455 / n));
}

TEST(ImageModel, SameStreamSameBytesOtherStreamOtherBytes) {
  const CameraSheet sheet = sheetOf(64, 48);
  const ImageModel model(sheet, kTurbid);
  const cv::Mat light = uniformLight(sheet, 0.4);
  const auto exposed = [&](std::uint64_t seed, std::uint64_t number) {
    Random random = Random::stream(seed, number);
    return model.expose(light, &random);
  };
  EXPECT_EQ(cv::norm(exposed(1, 5), exposed(1, 5), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(exposed(1, 5), exposed(1, 6), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(exposed(1, 5), exposed(2, 5), cv::NORM_INF), 0);
}

TEST(ImageModel, ImagesOfAnotherSizeAreRefused) {
  const CameraSheet sheet = sheetOf(64, 48);
  const ImageModel model(sheet, kTurbid);
  EXPECT_THROW(model.expose(uniformLight(sheetOf(32, 48), 0.1), nullptr), std::invalid_argument);
  EXPECT_THROW(model.light(uniformLight(sheet, 0.1), cv::Mat(48, 64, CV_64FC1)), std::invalid_argument);
}

std::string complaintOfWater(const std::string& text) {
  const auto file = test::scratchFolder() / "water.yaml";
  writeTextFile(file, text);
  try {
    readEnvironment(file);
  } catch (const Error& error) {
    return error.where + ": " + error.why;
  }
  return "none";
}

TEST(Environment, IsReadAsWritten) {
  const auto file = test::scratchFolder() / "water.yaml";
  writeTextFile(
      file,
      "water: {attenuation_per_m: [0.4, 0.2, 0.1], veil: [0.1, 0.2, 0.3]}\nambient: [0.7, 0.8, 0.9]\n"
      "lamps_irradiance_1m: [1, 2, 3]\n");
  const Environment environment = readEnvironment(file);
  EXPECT_EQ(environment.water.attenuation_per_m, Vector3d(0.4, 0.2, 0.1));
  EXPECT_EQ(environment.water.veil, Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(environment.ambient, Vector3d(0.7, 0.8, 0.9));
  EXPECT_EQ(*environment.lamps_irradiance_1m, Vector3d(1, 2, 3));
}

TEST(Environment, MistakesAreNamed) {
  const std::string water = "water: {attenuation_per_m: [0.4, 0.2, 0.1], veil: [0.1, 0.2, 0.3]}\n",
                    ambient = "ambient: [0.7, 0.8, 0.9]\n";
  EXPECT_EQ(complaintOfWater(water + ambient), "none");
  EXPECT_NE(complaintOfWater(water).find("ambient"), std::string::npos);
  EXPECT_NE(complaintOfWater(ambient).find("water"), std::string::npos);
  EXPECT_NE(complaintOfWater(water + ambient + "lamp: 3\n").find("lamp"), std::string::npos);
  EXPECT_NE(complaintOfWater(water + "ambient: [0.7, -0.8, 0.9]\n").find("below zero"), std::string::npos);
  EXPECT_NE(complaintOfWater("water: {attenuation_per_m: [0.4, 0.2], veil: [0.1, 0.2, 0.3]}\n" + ambient)
                .find("attenuation_per_m"),
            std::string::npos);
  EXPECT_NE(
      complaintOfWater("water: {attenuation_per_m: [-0.4, 0.2, 0.2], veil: [0.1, 0.2, 0.3]}\n" + ambient)
          .find("below zero"),
      std::string::npos);
  EXPECT_NE(complaintOfWater("water: {attenuation_per_m: [0.4, 0.2, 0.2], veil: [0.1, 1.2, 0.3]}\n" + ambient)
                .find("veil"),
            std::string::npos);
  EXPECT_NE(complaintOfWater(water + "ambient: [0.7, .nan, 0.9]\n").find("ambient"), std::string::npos);
}

}  // namespace
}  // namespace fathom
