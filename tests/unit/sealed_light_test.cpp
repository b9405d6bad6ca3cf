// The sealed generator's light: its images against the base equation, its lamps against quadrature.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "sealed/images.h"
#include "sealed/lamp_light.h"
#include "sealed/panel_design.h"
#include "support/sealed_example.h"
#include "support/shared_data.h"

namespace fathom::sealed {
namespace {

/// A camera before the panel, and what it sees of one marker.
struct Scene {
  explicit Scene(const std::string& effects)
      : sealed(exampleCase(effects, "images")),
        panel(readMap(), sealed),
        dive(makeDive("rich", 3, {6, 0, -4.2})),
        viewpoint(vehicle, sealed, dive) {}

  static PanelMap readMap() {
    const auto folder = test::scratchFolder();
    writePanel(folder, false);
    return readPanelMap(folder / "panel.yaml");
  }
  cv::Mat3b image() const { return ImageMaker(vehicle, sealed, panel, viewpoint).take(0, kStamp_s); }
  Vector3d camera_panel() const {
    return panel.map().T_odom_panel.inverse() * viewpoint.T_odom_camera(kStamp_s, kStamp_s).position;
  }
  Vector3d inCamera(const Vector3d& point_panel) const {
    return viewpoint.T_odom_camera(kStamp_s, kStamp_s).inverse() * (panel.map().T_odom_panel * point_panel);
  }

  static constexpr double kStamp_s = 2.0;
  Vehicle vehicle;
  SealedCase sealed;
  TruePanel panel;
  Dive dive;
  Viewpoint viewpoint;
};

/// Calls check(pixel, point in camera) for the white margin left of each marker's border that is well in
/// view.
template <class Check>
int forEachWhiteMargin(const Scene& scene, const Check& check) {
  int seen = 0;
  for (const Marker& marker : scene.panel.map().markers) {
    const auto corners = marker.corners_panel();
    const Vector3d outwards = (corners[0] - corners[1]).normalized();
    const Vector3d point = scene.inCamera((corners[0] + corners[3]) / 2 + outwards * marker.size_m * 0.08);
    const auto pixel = TrueCamera(scene.vehicle.camera, scene.sealed, 0).pixelOf(point);
    if (!pixel || (pixel->array() < 5).any() || pixel->x() > 634 || pixel->y() > 474) continue;
    check(cv::Point(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y()))),
          point);
    ++seen;
  }
  return seen;
}

TEST(SealedImages, NothingHiddenIsTheBaseEquation) {
  const Scene scene("[]");
  const cv::Mat3b image = scene.image();
  const WaterLight water = waterLightAt(scene.sealed, 0, 0);
  const int seen = forEachWhiteMargin(scene, [&](const cv::Point& pixel, const Vector3d& point) {
    const Array3d kept = (-water.attenuation_per_m * point.z()).exp();
    const Array3d expected_dn = 255 * (0.85 * water.daylight * kept + (1 - kept) * water.veil);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(image(pixel)[2 - c], expected_dn[c], 0.51 + 0.1);  // half a pixel's z
  });
  EXPECT_GT(seen, 4);
  EXPECT_NEAR(image(2, 2)[0], 255 * water.veil[2], 0.51);
}

TEST(SealedImages, SlantRangeAndVignettingDarkenTheCorners) {
  const Scene scene(R"([{"id": "slant-range", "parameters": {"slant_share": 1}},
                        {"id": "vignetting", "parameters": {"corner_loss": 0.2}}])");
  const cv::Mat3b image = scene.image();
  const WaterLight water = waterLightAt(scene.sealed, 0, 0);
  forEachWhiteMargin(scene, [&](const cv::Point& pixel, const Vector3d& point) {
    const Array3d kept = (-water.attenuation_per_m * point.norm()).exp();
    const double slope2 = point.head<2>().squaredNorm() / (point.z() * point.z());
    const double passed = std::pow(0.8, std::log(1 + slope2) / std::log(1 + 0.72 * 0.72));
    const Array3d expected_dn = 255 * passed * (0.85 * water.daylight * kept + (1 - kept) * water.veil);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image(pixel)[2 - c], expected_dn[c], 0.51 + 0.3);
  });
}

/// Mean light of an image that hides nothing, red, green, blue.
Vector3d meanLight(const Scene& scene) {
  const cv::Scalar mean = cv::mean(scene.image());
  return Vector3d(mean[2], mean[1], mean[0]) / 255;
}

TEST(SealedImages, CamerasDoToLightWhatTheirEffectsSay) {
  const Vector3d mean = meanLight(Scene("[]"));
  struct Told {
    const char* effect;
    std::function<double(double, int, const Vector2d&)> reading;  // of light, colour and tangents
  };
  const std::vector<Told> all{
      {R"([{"id": "flat-field", "parameters": {"slope": [0.2, -0.1]}}])",
       [](double light, int, const Vector2d& at) { return light * std::exp(0.2 * at.x() - 0.1 * at.y()); }},
      {R"([{"id": "response-curve", "parameters": {"bend": [0.3, 0.1, -0.2]}}])",
       [](double light, int c, const Vector2d&) {
         return light + std::array{0.3, 0.1, -0.2}[static_cast<std::size_t>(c)] * light * (1 - light);
       }},
      {R"([{"id": "veiling-glare", "parameters": {"glare_share": 0.1}}])",
       [&](double light, int c, const Vector2d&) { return 0.9 * light + 0.1 * mean[c]; }},
      // Far from an edge it is not seen.
      {R"([{"id": "defocus", "parameters": {"blur_px": 0.5}}])",
       [](double light, int, const Vector2d&) { return light; }}};
  for (const Told& told : all) {
    const Scene scene(told.effect);
    const cv::Mat3b image = scene.image();
    const WaterLight water = waterLightAt(scene.sealed, 0, 0);
    const int seen = forEachWhiteMargin(scene, [&](const cv::Point& pixel, const Vector3d& point) {
      const Array3d kept = (-water.attenuation_per_m * point.z()).exp();
      const Array3d light = 0.85 * water.daylight * kept + (1 - kept) * water.veil;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(image(pixel)[2 - c], 255 * told.reading(light[c], c, point.head<2>() / point.z()),
                    0.51 + 0.3)
            << told.effect;
    });
    EXPECT_GT(seen, 4);
  }
}

/// What is on either side of the steepest place in a row through the middle of a marker's border.
double steepestStep(const cv::Mat3b& image) {
  double steepest = 0;
  for (int row = 0; row < image.rows; ++row)
    for (int column = 1; column < image.cols; ++column)
      steepest = std::max(steepest, std::abs(double(image(row, column)[1]) - image(row, column - 1)[1]));
  return steepest;
}

TEST(SealedImages, EdgesAreSofterOutOfFocusAndHarderSharpened) {
  const auto with = [](const char* effect) { return steepestStep(Scene(effect).image()); };
  const double plain = with("[]");
  EXPECT_LT(with(R"([{"id": "defocus", "parameters": {"blur_px": 1}}])"), 0.75 * plain);
  const char* sharpening = R"([{"id": "sharpening", "parameters": {"amount": 0.5}}])";
  EXPECT_GT(with(sharpening), 1.2 * plain);
  // What a rim has too much on one side it lacks on the other; numbers are rounded to half of one.
  EXPECT_LT(cv::norm(cv::mean(Scene(sharpening).image()) - cv::mean(Scene("[]").image())), 0.1);
}

// Interpolated colours soften edges a little, and compression changes most pixels; neither changes the mean
// of a colour by more than rounding it does, half a number, nor all three by more than so each.
TEST(SealedImages, ColoursAreInterpolatedAndImagesCompressed) {
  const Scene plain("[]");
  const cv::Mat before = plain.image();
  for (const char* effect : {R"([{"id": "demosaicing", "parameters": {"interpolated": 1}}])",
                             R"([{"id": "image-compression", "parameters": {"table_scale": 0.3}}])"}) {
    const cv::Mat after = Scene(effect).image();
    EXPECT_GT(cv::norm(before, after, cv::NORM_L1), 0.05 * static_cast<double>(before.total())) << effect;
    EXPECT_LT(cv::norm(cv::mean(before) - cv::mean(after)), 0.5 * std::sqrt(3.0)) << effect;
  }
  EXPECT_LT(steepestStep(Scene(R"([{"id": "demosaicing", "parameters": {"interpolated": 1}}])").image()),
            steepestStep(before));
}

// A film of algae, as much of it everywhere but for a sixth; other markers stay.
TEST(SealedImages, GrowthDarkensOneMarkersWhite) {
  const Scene plain("[]"), fouled(R"([{"id": "biofouling", "parameters":
      {"marker_id": 420, "covered": 0.4, "growth_albedo": [0.08, 0.08, 0.08]}}])");
  const cv::Mat3b before = plain.image(), after = fouled.image();
  const WaterLight water = waterLightAt(plain.sealed, 0, 0);
  int changed = 0;
  forEachWhiteMargin(plain, [&](const cv::Point& pixel, const Vector3d& point) {
    const double most = 0.4 * 1.42 * (0.85 - 0.08), kept = std::exp(-water.attenuation_per_m[1] * point.z());
    const double darker_dn = double(before(pixel)[1]) - after(pixel)[1];
    if (darker_dn == 0) return;
    ++changed;
    EXPECT_GT(darker_dn, 255 * 0.5 * 0.4 * (0.85 - 0.08) * water.daylight[1] * kept - 1);
    EXPECT_LT(darker_dn, 255 * most * water.daylight[1] * kept + 1);
  });
  EXPECT_LE(changed, 1);
  EXPECT_GT(cv::norm(before, after, cv::NORM_L1), 0);
}

TEST(SealedImages, WhatIsBeforeAPartOfTheViewIsSeenThere) {
  const cv::Mat3b before = Scene("[]").image();
  const cv::Mat3b after = Scene(R"([{"id": "occlusion", "parameters":
      {"left": 0.5, "right": 1, "top": 0, "bottom": 1, "covered": 0.5, "brightness": 0.2}}])")
                              .image();
  for (const cv::Point& pixel : {cv::Point(600, 100), cv::Point(620, 400)})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(after(pixel)[c], 0.5 * before(pixel)[c] + 0.5 * 0.2 * 255, 1);
  EXPECT_EQ(after(240, 100), before(240, 100));
}

// Gains of each image and colour, anew for each.
TEST(SealedImages, ColoursAreWeighedAnewForEachImage) {
  const Scene plain("[]"),
      weighed(R"([{"id": "white-balance", "parameters": {"log_gain_sd": [0.2, 0, 0.1]}}])");
  const cv::Scalar before = cv::mean(plain.image()), after = cv::mean(weighed.image());
  EXPECT_GT(std::abs(after[2] / before[2] - 1), 0.01);
  EXPECT_NEAR(after[1], before[1], 1e-9);
  EXPECT_GT(std::abs(after[0] / before[0] - 1), 0.005);
}

TEST(SealedImages, TheSameImageAgain) {
  const Scene scene(R"([{"id": "marine-snow", "parameters": {"particles_per_m3": 100}}])");
  EXPECT_EQ(cv::norm(scene.image(), scene.image(), cv::NORM_INF), 0);
}

/// Adaptive Simpson quadrature.
double integral(const std::function<double(double)>& f, double from, double to, double tolerance) {
  const auto simpson = [&](double a, double b) { return (b - a) / 6 * (f(a) + 4 * f((a + b) / 2) + f(b)); };
  const double middle = (from + to) / 2;
  const double whole = simpson(from, to), halves = simpson(from, middle) + simpson(middle, to);
  if (std::abs(whole - halves) < 15 * tolerance) return halves + (halves - whole) / 15;
  return integral(f, from, middle, tolerance / 2) + integral(f, middle, to, tolerance / 2);
}

TEST(SealedLamps, GlowIsTheIntegralOverTheLineOfSight) {
  const SealedCase sealed = exampleCase("[]", "images");
  const Vehicle vehicle;
  const SightLines sight(TrueCamera(vehicle.camera, sealed, 0), 640, 480);
  const WaterLight water = waterLightAt(sealed, 0, 0);
  const LampLight lamps(vehicle, 1.5, water, water.daylight, sight);
  for (const Vector2d& pixel : {Vector2d(10, 20), Vector2d(325, 250), Vector2d(600, 300)})
    for (const double range_m : {0.5, 1.3, 4.0}) {
      const Vector3d direction = sight.at(pixel).direction.normalized();
      for (int c = 0; c < 3; ++c) {
        const double share_per_m = water.attenuation_per_m[c] * water.veil[c] / water.daylight[c];
        const auto integrand = [&](double along_m) {
          const Vector3d point = direction * along_m;
          return share_per_m * lamps.irradianceAt(point)[c] *
                 std::exp(-water.attenuation_per_m[c] * point.z());
        };
        const double expected = integral(integrand, 0, range_m, 1e-9);
        EXPECT_NEAR(lamps.glow(pixel, range_m)[c], expected, 0.0015 * expected + 1e-6);
      }
    }
}

/// Mean over the sphere, and the share of it that is scattered back: by cosines, finer where it peaks.
double sphereMean(const PhaseFunction& phase, double from_deg) {
  double sum = 0;
  for (double angle = from_deg; angle < 180;) {
    const double next = std::min(180.0, std::max(angle * 1.01, angle + 1e-4)),
                 middle = radians((angle + next) / 2);
    sum += phase(std::cos(middle)) * std::sin(middle) * radians(next - angle) / 2;
    angle = next;
  }
  return sum;
}

// What was measured begins at 0.1 degrees, before which it is extrapolated; Mobley 1994 has 0.0183 of it
// behind.
TEST(SealedLamps, PhaseFunctionsAreOfOneWhole) {
  EXPECT_NEAR(sphereMean(henyeyGreenstein(0.9), 0), 1, 0.002);
  EXPECT_NEAR(sphereMean(henyeyGreenstein(0), 0), 1, 0.002);
  EXPECT_NEAR(sphereMean(fournierForand(1.10, 3.58), 0), 1, 0.02);
  EXPECT_NEAR(sphereMean(petzold(), 0), 1, 0.03);
  EXPECT_NEAR(sphereMean(petzold(), 90), 0.0183, 0.001);
  // With these two numbers Fournier and Forand's is Petzold's (Mobley, Sundman & Boss 2002).
  EXPECT_NEAR(sphereMean(fournierForand(1.10, 3.5835), 90), 0.0183, 0.001);
}

TEST(SealedLamps, IrradianceIsThatOfADataSheet) {
  const SealedCase sealed = exampleCase("[]", "images");
  const Vehicle vehicle;
  const SightLines sight(TrueCamera(vehicle.camera, sealed, 0), 640, 480);
  const WaterLight water = waterLightAt(sealed, 0, 0);
  const LampLight both(vehicle, 1.0, water, water.daylight, sight);
  const Pose T_camera_lamp = vehicle.camera.pose.pose().inverse() * vehicle.lamps[0].pose.pose();
  const Vector3d ahead = T_camera_lamp * Vector3d(20, 0, 0);  // far off, both are at nearly one place
  const double alone = 0.87 * std::exp(-water.attenuation_per_m[2] * 20) / 400;
  EXPECT_NEAR(both.irradianceAt(ahead)[2] / alone, 2, 0.15);
}

}  // namespace
}  // namespace fathom::sealed
