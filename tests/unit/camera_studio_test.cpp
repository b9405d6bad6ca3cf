// What moves while the shutter is open is smeared along its way.
#include "simulation/camera_studio.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "effects/registry.h"
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

TEST(CameraStudio, WhatStandsStillIsSharp) {
  const Sideways still(0);
  EXPECT_EQ(cv::norm(still.image(0), still.image(kExposure_s)), 0);
}

}  // namespace
}  // namespace fathom
