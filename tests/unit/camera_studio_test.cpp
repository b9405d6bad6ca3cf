// What moves while the shutter is open is smeared along its way.
#include "simulation/camera_studio.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "effects/registry.h"
#include "support/panels.h"
#include "support/shipped.h"

namespace fathom {
namespace {

constexpr double kExposure_s = 0.1, kWay_px = 6;

/// A camera square before the middle of the shipped panel, in clear water, that moves sideways.
struct Sideways {
  PanelMap panel = readPanelMap(test::kDexrovMap);
  CameraSheet sheet;
  CameraShot shot;

  explicit Sideways(double velocity_px_s) {
    for (Marker& marker : panel.markers) marker.T_panel_marker.position.z() = 0;
    panel.handles.clear();  // which stand out, and move otherwise
    CameraModel& lens = sheet.model;
    lens.width_px = 320, lens.height_px = 240;
    lens.fx_px = lens.fy_px = 277;
    lens.cx_px = 160, lens.cy_px = 120;
    constexpr double kRange_m = 1.5;
    shot.T_odom_robot =
        panel.T_odom_panel * Pose{expSO3<double>(Vector3d(std::numbers::pi, 0, 0)), {0, 0, kRange_m}};
    shot.camera = {Pose{}, lens, CameraProjector<double>::nominal(lens)};
    shot.camera.projector.velocity_camera.x() = velocity_px_s * kRange_m / lens.fx_px;
  }

  /// In linear light, of 16 bits.
  cv::Mat image(double exposure_s) const {
    EffectParameters<double> effects;
    effects.on.set(kEffectIndex<MotionBlur>);
    *effects.of<MotionBlur>() = exposure_s * exposure_s;
    return imageWith(effects, sheet.exposure_s);
  }
  cv::Mat imageAsStated(double exposure_s) const { return imageWith({}, exposure_s); }

 private:
  cv::Mat imageWith(const EffectParameters<double>& effects, double stated_s) const {
    CameraSheet fine = sheet;
    fine.bits = 16;
    fine.exposure_s = stated_s;
    const CameraStudio studio({{panel}, {}, {}}, fine, {}, effects);
    cv::Mat light;
    studio.image(shot, nullptr).convertTo(light, CV_32F, 1.0 / 65535);
    return light;
  }
};

double rmsInside(const cv::Mat& a, const cv::Mat& b) {
  const cv::Rect inside(60, 60, 200, 120);
  return cv::norm(a(inside), b(inside)) / std::sqrt(3.0 * inside.area());
}

// A pixel's mean over a way of six pixels: whole ones, but for a half at either end.
TEST(CameraStudio, WhatMovesIsSmearedAlongItsWay) {
  const Sideways moving(kWay_px / kExposure_s);
  cv::Mat box = cv::Mat::ones(1, 7, CV_32F) / kWay_px, expected;
  box.at<float>(0, 0) = box.at<float>(0, 6) = static_cast<float>(0.5 / kWay_px);
  const cv::Mat sharp = moving.image(0), smeared = moving.image(kExposure_s);
  cv::filter2D(sharp, expected, CV_32F, box);
  // A twentieth of what changes is how pixels are taken to be filled: a sharp edge within one, as a slope
  // over two.
  EXPECT_GT(rmsInside(sharp, expected), 0.05);
  EXPECT_LT(rmsInside(smeared, expected), rmsInside(sharp, expected) / 20);
}

// The effect counts instead of what the vehicle file states.
TEST(CameraStudio, TheStatedExposureSmearsAsTheEffectDoes) {
  const Sideways moving(kWay_px / kExposure_s);
  EXPECT_EQ(cv::norm(moving.imageAsStated(kExposure_s), moving.image(kExposure_s)), 0);
  EXPECT_GT(cv::norm(moving.imageAsStated(kExposure_s), moving.image(0)), 1);
}

// A board that lies under water is rendered where the forward model has the corners of its face, seen from
// the air: five pixels to the inside it is there, five to the outside it is not (of its sides two show).
TEST(CameraStudio, WhatLiesUnderWaterIsWhereItIsSeenFromTheAir) {
  PanelMap board = test::BoardFiles{}.read();  // 1.0 m by 0.6 m
  board.T_odom_panel = {};
  board.markers.clear();
  board.handles.clear();
  CameraSheet sheet;
  CameraModel& lens = sheet.model;
  lens.width_px = 320, lens.height_px = 240;
  lens.fx_px = lens.fy_px = 277;
  lens.cx_px = 160, lens.cy_px = 120;
  lens.above_water = true;
  KinematicState<double> robot;  // which is the camera
  robot.R_odom_robot =
      Vector3d(1, -1, -1).asDiagonal() * expSO3<double>(Vector3d(radians(-20), radians(8), 0));
  robot.position_odom = -1.9 * robot.R_odom_robot.col(2);
  EffectParameters<double> water;
  water.add<FlatWaterSurface>({1.0, 0, 0, 0});
  const Vector3d at_origin = Vector3d::Zero();
  const TrueCamera camera = trueCamera(lens, {}, robot, water, 0, {}, at_origin);
  const CameraShot shot{{robot.R_odom_robot, robot.position_odom}, camera, 0};
  const CameraStudio studio({{board}, {}, {}}, sheet, {}, water);
  const cv::Mat mask = studio.panelMask(shot, studio.renderAlbedo(shot));
  const auto pixelOf = [&](double x_m, double y_m) {
    return camera.projector.project(Vector3d(shot.T_odom_camera().inverse() * Vector3d(x_m, y_m, 0)));
  };
  const Vector2d middle = pixelOf(0, 0);
  const auto isThere = [&](const Vector2d& pixel) {
    return mask.at<std::uint8_t>(static_cast<int>(std::lround(pixel.y())),
                                 static_cast<int>(std::lround(pixel.x()))) > 0;
  };
  for (const double x_m : {-0.5, 0.5})
    for (const double y_m : {-0.3, 0.3}) {
      const Vector2d corner = pixelOf(x_m, y_m), outward = (corner - middle).normalized();
      EXPECT_TRUE(isThere(corner - 5 * outward)) << x_m << " " << y_m;
      EXPECT_FALSE(isThere(corner + 5 * outward)) << x_m << " " << y_m;
      const Vector2d straight = lens.project<double>(shot.T_odom_camera().inverse() * Vector3d(x_m, y_m, 0));
      EXPECT_GT((corner - straight).norm(), 7) << "water that nobody sees";
    }
}

TEST(CameraStudio, WhatStandsStillIsSharp) {
  const Sideways still(0);
  EXPECT_EQ(cv::norm(still.image(0), still.image(kExposure_s)), 0);
}

}  // namespace
}  // namespace fathom
