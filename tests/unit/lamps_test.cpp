// The vehicle's lamps: the formulas against themselves written out, the table against direct integration.
#include "imaging/lamps.h"

#include <gtest/gtest.h>

#include "effects/lamp.h"
#include "imaging/image_patch.h"
#include "imaging/lamp_glow.h"

namespace fathom {
namespace {

const Environment kLitSea{{{0.4, 0.2, 0.15}, {0.05, 0.15, 0.2}}, {0.6, 0.7, 0.65}, {}};

/// To the left of a camera that looks along the robot's x.
LampSheet lampBeside() {
  LampSheet lamp;
  lamp.half_angle_rad = radians(32);
  lamp.T_robot_lamp = {rotationFromYawPitchRoll(radians(-6), radians(3), 0), {0.33, 0.28, 0.14}};
  return lamp;
}

LitSight<double> sightOf(const Vector3d& direction_robot, double asymmetry = 0) {
  const Vector3d ray = direction_robot.normalized();
  return {{0.35, 0, 0.05}, ray, ray.x(), kLitSea.water, kLitSea.ambient, asymmetry};
}

TEST(Lamps, FallWithTheSquareOfTheDistanceAndToHalfAtTheHalfAngle) {
  LampSheet lamp;
  lamp.half_angle_rad = radians(32);
  const auto at = [&](double distance_m, double angle_rad, const Vector3d& attenuation_per_m) {
    return lampIrradiance<double>(lamp, distance_m * Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0),
                                  attenuation_per_m);
  };
  const Vector3d clear = Vector3d::Zero();
  EXPECT_NEAR(at(1, 0, clear)[0], 1, 1e-12);
  EXPECT_NEAR(at(3, 0, clear)[1], 1 / 9.0, 1e-12);
  EXPECT_NEAR(at(1, lamp.half_angle_rad, clear)[2], 0.5, 1e-12);
  EXPECT_NEAR(at(2, 0, {0, 0.3, 0})[1], 0.25 * std::exp(-0.6), 1e-12);
}

TEST(Lamps, LightASurfaceByTheCosineAndNotFromBehind) {
  const std::vector<LampSheet> lamps{LampSheet{.name = "", .half_angle_rad = 1, .T_robot_lamp = {}}};
  const Vector3d point(2, 0, 0);
  const auto on = [&](double angle_rad) {
    return lampsOnSurface<double>(lamps, point, {-std::cos(angle_rad), std::sin(angle_rad), 0},
                                  Vector3d::Zero())[0];
  };
  EXPECT_NEAR(on(0), 0.25, 1e-12);
  EXPECT_NEAR(on(1), 0.25 * std::cos(1), 1e-12);
  EXPECT_EQ(on(2), 0);
}

/// What a camera gains on its way, the sum over many short pieces of the equation written out.
Vector3d integrated(const std::vector<LampSheet>& lamps, const LitSight<double>& sight, double range_m) {
  constexpr int kPieces = 200000;
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < kPieces; ++i) {
    const double s = (i + 0.5) * range_m / kPieces;
    for (const LampSheet& lamp : lamps) {
      const Vector3d way = sight.camera_robot + s * sight.direction_robot - lamp.T_robot_lamp.position;
      const double d = way.norm(), cosine = lamp.T_robot_lamp.rotation.col(0).dot(way) / d;
      const double beam = std::pow(0.5, (1 - cosine) / (1 - std::cos(lamp.half_angle_rad))) / (d * d);
      const double g = sight.asymmetry, turned = way.dot(-sight.direction_robot) / d;
      const double phase = (1 - g * g) * std::pow(1 + g * g - 2 * g * turned, -1.5);
      for (int c = 0; c < 3; ++c) {
        const double a = kLitSea.water.attenuation_per_m[c];
        sum[c] += range_m / kPieces * beam * phase * std::exp(-a * d) * a * kLitSea.water.veil[c] /
                  kLitSea.ambient[c] * std::exp(-a * s * sight.z_per_range);
      }
    }
  }
  return sum;
}

// To a tenth of a digital number of 255 for lamps of irradiance 4.
TEST(Lamps, ScatteringOnTheWayIsTheIntegralOfWhatIsScattered) {
  const std::vector<LampSheet> lamps{lampBeside()};
  for (const double asymmetry : {0.0, 0.9})
    for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(1, 0.4, -0.2), Vector3d(1, -0.6, 0.3)})
      for (const double range_m : {0.3, 1.0, 2.5, 8.0, 30.0}) {
        const LitSight<double> sight = sightOf(direction, asymmetry);
        const Vector3d direct = integrated(lamps, sight, range_m);
        EXPECT_LT((lampsInWater(lamps, sight, range_m) - direct).cwiseAbs().maxCoeff(), 1e-4)
            << direction.transpose() << " " << range_m << " " << asymmetry;
        EXPECT_GT(direct.maxCoeff(), asymmetry > 0 ? 0 : 2e-4);
      }
}

// Light is scattered somewhere, and its mean cosine is the asymmetry: by the midpoint rule over the sphere.
TEST(Lamps, ThePhaseFunctionKeepsAllLight) {
  for (const double g : {-0.4, 0.0, 0.5, 0.9}) {
    constexpr int kPieces = 100000;
    double all = 0, cosines = 0;
    for (int i = 0; i < kPieces; ++i) {
      const double cosine = -1 + (i + 0.5) * 2 / kPieces;
      all += henyeyGreenstein(g, cosine) / kPieces;
      cosines += cosine * henyeyGreenstein(g, cosine) / kPieces;
    }
    EXPECT_NEAR(all, 1, 1e-5) << g;
    EXPECT_NEAR(cosines, g, 1e-5) << g;
  }
}

// A black place shows what the water scatters and nothing else: of a water that scatters a seventh as much,
// a seventh of it.
TEST(Lamps, WhatComesBackNeedNotBeDaylightsShare) {
  const std::vector<LampSheet> lamps{lampBeside()};
  ImagePatch black;
  black.T_robot_camera = {rotationFromYawPitchRoll(radians(-90), 0, radians(-90)), {0.35, 0, 0.05}};
  black.around_panel.fill(Vector3d::Zero());
  KinematicState<double> still{};
  still.R_odom_robot.setIdentity();
  const Pose T_odom_panel{rotationFromYawPitchRoll(radians(180), radians(90), 0), {3.1, 0.4, 0.2}};
  Vector9<double> water;
  water << kLitSea.water.attenuation_per_m, kLitSea.water.veil, kLitSea.ambient;
  const auto seen = [&](std::optional<std::array<double, 3>> lit) {
    EffectParameters<double> effects;
    if (lit) effects.add<Lamp>(*lit);
    const auto panel = nominalPlacement<double>(T_odom_panel, 0);
    return predictPatch<double>(still, panel, black, lamps, water, effects, 0);
  };
  const Vector3d way = T_odom_panel.position - black.T_robot_camera.position;
  const Vector3d whole = 1.2 * 0.87 * integrated(lamps, sightOf(way), way.norm());
  const Vector3d daylight = seen({});
  for (const auto& [ln_scatter, share] : {std::pair{0.0, 1.0}, {-std::log(7.0), 1 / 7.0}})
    EXPECT_LT((seen({{1.2, ln_scatter, 0}}) - daylight - share * whole).cwiseAbs().maxCoeff(), 1e-5 * share);
  EXPECT_GT(whole.minCoeff(), 1e-3);

  // A lamp beside the camera is scattered by 90 to 180 degrees on its way into it, beyond where it is
  // nearest.
  const double behind = henyeyGreenstein(0.9, -1.0), abreast = henyeyGreenstein(0.9, 0.0);
  const Vector3d forward = seen({{1.2, 0, 0.9}}) - daylight;
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(forward[c], behind * whole[c]);
    EXPECT_LT(forward[c], abreast * whole[c]);
  }
}

// To a fifth of a digital number, likewise.
TEST(Lamps, TheTableIsTheIntegralOfEveryPixel) {
  const CameraModel camera{
      .width_px = 330, .height_px = 241, .fx_px = 278, .fy_px = 277, .cx_px = 160, .cy_px = 122};
  const Pose T_robot_camera{rotationFromYawPitchRoll(radians(-90), 0, radians(-92)), {0.35, 0, 0.05}};
  const std::vector<LampSheet> lamps{lampBeside()};
  cv::Mat range_m(camera.height_px, camera.width_px, CV_32FC1);
  for (int v = 0; v < range_m.rows; ++v)
    for (int u = 0; u < range_m.cols; ++u)
      range_m.at<float>(v, u) =
          v < 40 ? std::numeric_limits<float>::infinity() : 0.4F + 0.01F * static_cast<float>(u);
  const cv::Mat glow = LampGlow(camera, T_robot_camera, lamps, kLitSea).upTo(range_m);
  for (int v = 0; v < range_m.rows; v += 20)
    for (int u = 1; u < range_m.cols; u += 47) {
      const Vector3d ray = camera.rayAt({u, v});
      const LitSight<double> sight{T_robot_camera.position, T_robot_camera.rotation * ray, ray.z(),
                                   kLitSea.water, kLitSea.ambient};
      const double range = range_m.at<float>(v, u);
      const Vector3d exact = lampsInWater(lamps, sight, std::min(range, 1e6));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(glow.at<cv::Vec3f>(v, u)[c], exact[c], 2e-4) << u << " " << v;
    }
}

}  // namespace
}  // namespace fathom
