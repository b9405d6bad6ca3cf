// Views of a panel: where the camera stands, and what its image shows.
#include "observables/views.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "fiducials/detector.h"
#include "support/shipped.h"

namespace fathom {
namespace {

using test::kSource;

const PanelMap& dexrov() {
  static const PanelMap map = readPanelMap(kSource / "maps/dexrov/panel.yaml");
  return map;
}
const Vehicle& rov() {
  static const Vehicle vehicle = readVehicle(kSource / "config/rov.yaml");
  return vehicle;
}

TEST(CameraView, StandsAndLooksAsItSays) {
  for (std::uint64_t k = 0; k < 200; ++k) {
    const CameraView view = drawView({}, 7, k);
    const Pose T = view.T_panel_camera();
    EXPECT_NEAR(T.position.norm(), view.range_m, 1e-12);
    EXPECT_NEAR(std::acos(T.position.normalized().z()), view.tilt_rad, 1e-7);
    EXPECT_NEAR(wrapAngle(std::atan2(T.position.y(), T.position.x()) - view.azimuth_rad), 0, 1e-9);
    EXPECT_NEAR((T.rotation * T.rotation.transpose() - Matrix3d::Identity()).norm(), 0, 1e-12);
    EXPECT_NEAR(T.rotation.determinant(), 1, 1e-12);
    // The optical axis meets the face at the aim.
    const Vector3d axis = T.rotation.col(2);
    const Vector3d met = T.position - axis * (T.position.z() / axis.z());
    EXPECT_LT((met.head<2>() - view.aim_panel).norm(), 1e-9);
    // Turned back by the roll, the camera's x is level: it has no part of the panel's y.
    const Vector3d level = T.rotation * expSO3<double>({0, 0, -view.roll_rad}) * Vector3d::UnitX();
    EXPECT_NEAR(level.y(), 0, 1e-12);
  }
}

TEST(CameraView, FacesThePanelUpright) {
  CameraView view;
  view.range_m = 2;
  const Pose T = view.T_panel_camera();
  EXPECT_LT((T.rotation.col(0) - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((T.rotation.col(1) + Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((T.rotation.col(2) + Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(DrawView, FillsItsRangesAndRepeats) {
  ViewRanges ranges;
  ranges.nearest_m = 1.5, ranges.farthest_m = 3;
  ranges.smallest_tilt_rad = radians(10), ranges.largest_tilt_rad = radians(50);
  double nearest = 9, farthest = 0, least = 9, most = 0, left = 9, right = -9;
  for (std::uint64_t k = 0; k < 500; ++k) {
    const CameraView view = drawView(ranges, 3, k), again = drawView(ranges, 3, k);
    EXPECT_EQ(view.range_m, again.range_m);
    EXPECT_EQ(view.aim_panel, again.aim_panel);
    EXPECT_NE(view.range_m, drawView(ranges, 4, k).range_m);
    nearest = std::min(nearest, view.range_m), farthest = std::max(farthest, view.range_m);
    least = std::min(least, view.tilt_rad), most = std::max(most, view.tilt_rad);
    left = std::min(left, view.roll_rad), right = std::max(right, view.roll_rad);
    EXPECT_LE(view.aim_panel.cwiseAbs().maxCoeff(), ranges.largest_aim_m);
    // Nearly all of a panel of 1.7 m shows, in any case some whole markers.
    EXPECT_GE(wholeMarkers(dexrov(), rov().camera->model, view.T_panel_camera()), 4U);
  }
  // Of 500 uniform numbers the extremes lie within 2 % of the ends (but for one case in 20000 each).
  EXPECT_GE(nearest, 1.5);
  EXPECT_LT(nearest, 1.53);
  EXPECT_LE(farthest, 3);
  EXPECT_GT(farthest, 2.97);
  EXPECT_GE(least, radians(10));
  EXPECT_LT(least, radians(10.8));
  EXPECT_LE(most, radians(50));
  EXPECT_GT(most, radians(49.2));
  EXPECT_LT(left, radians(-28.8));
  EXPECT_GT(right, radians(28.8));
}

TEST(DrawView, RefusesRangesWithoutSense) {
  const auto refuses = [](const std::function<void(ViewRanges&)>& spoil) {
    ViewRanges ranges;
    spoil(ranges);
    EXPECT_THROW(drawView(ranges, 1, 0), std::invalid_argument);
  };
  refuses([](auto& r) { r.nearest_m = 0; });
  refuses([](auto& r) { r.farthest_m = 0.5; });
  refuses([](auto& r) { r.farthest_m = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](auto& r) { r.largest_tilt_rad = radians(95); });
  refuses([](auto& r) { r.smallest_tilt_rad = radians(70); });
  refuses([](auto& r) { r.largest_roll_rad = -1; });
  refuses([](auto& r) { r.largest_aim_m = 2; });
}

TEST(WholeMarkers, CountsWhatLiesInTheImageAndFacesIt) {
  CameraView view;
  view.range_m = 3;
  const CameraModel& camera = rov().camera->model;
  EXPECT_EQ(wholeMarkers(dexrov(), camera, view.T_panel_camera()), 12U);
  view.range_m = 0.5;  // the image spans 0.58 m: markers 0.4 m off the centre do not fit
  EXPECT_LT(wholeMarkers(dexrov(), camera, view.T_panel_camera()), 5U);
  const Pose behind{rotationFromYawPitchRoll(0, 0, 0), Vector3d(0, 0, -3)};
  EXPECT_EQ(wholeMarkers(dexrov(), camera, behind), 0U);
}

TEST(ViewStudio, ShowsMarkersWhereTheViewHasThem) {
  const Environment water = readEnvironment(kSource / "config/water_clear.yaml");
  const ViewStudio studio(dexrov(), rov(), water);
  const CameraModel& camera = rov().camera->model;
  const auto detector = makeDetector(Backend::apriltag, {"DICT_ARUCO_ORIGINAL"});
  ViewRanges two_metres;
  two_metres.nearest_m = two_metres.farthest_m = 2;
  const CameraView view = drawView(two_metres, 1, 0);
  const cv::Mat image = studio.image(view, 1);
  const auto detections = detector->detect(image);
  EXPECT_EQ(detections.size(), wholeMarkers(dexrov(), camera, view.T_panel_camera()));
  EXPECT_GE(detections.size(), 10U);
  const Pose T_camera_panel = view.T_panel_camera().inverse();
  for (const Detection& detection : detections)
    for (const Marker& marker : dexrov().markers) {
      if (marker.id != detection.id) continue;
      const auto corners = marker.corners_panel();
      for (std::size_t k = 0; k < 4; ++k)  // the lens, unknown to this detector, bends edges by a hundredth
        EXPECT_LT((camera.project<double>(T_camera_panel * corners[k]) - detection.corners_px[k]).norm(),
                  0.2);
    }

  const auto differ = [](const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) > 0; };
  EXPECT_FALSE(differ(image, studio.image(view, 1)));
  EXPECT_TRUE(differ(image, studio.image(view, 2)));
  EXPECT_TRUE(differ(image, studio.imageWithoutNoise(view)));
  CameraView other = view;
  other.number = 1;
  EXPECT_TRUE(differ(image, studio.image(other, 1)));

  Environment lit = water;
  lit.lamps_irradiance_1m = Vector3d(2, 2, 2);
  EXPECT_GT(cv::mean(ViewStudio(dexrov(), rov(), lit).image(view, 1))[1], cv::mean(image)[1] + 3);
  Vehicle blind = rov();
  blind.camera.reset();
  EXPECT_THROW(ViewStudio(dexrov(), blind, water), std::invalid_argument);
}

/// A view from two metres, with these effects.
cv::Mat imageWith(const EffectParameters<double>& effects, CameraView view = {}) {
  static const Environment water = readEnvironment(kSource / "config/water_clear.yaml");
  view.range_m = 2;
  return ViewStudio(dexrov(), rov(), water, effects).image(view, 1);
}

TEST(ViewStudio, DrawsEffectsForEachView) {
  EffectParameters<double> effects;
  effects.add<AutoExposure>({0.3});
  CameraView other;
  other.number = 1;
  const double nominal = cv::mean(imageWith({}))[1], one = cv::mean(imageWith(effects))[1],
               another = cv::mean(imageWith(effects, other))[1];
  EXPECT_GT(std::abs(one / nominal - 1), 0.01);
  EXPECT_GT(std::abs(another / one - 1), 0.01);
  EXPECT_EQ(cv::norm(imageWith(effects), imageWith(effects), cv::NORM_INF), 0);
}

TEST(ViewStudio, HasTheEffectsOfTheViewsTime) {
  EffectParameters<double> effects;
  effects.add<Gamma>({0.5});
  effects.active_s[kEffectIndex<Gamma>] = {10, 20};
  CameraView later;
  later.t_s = 15;
  EXPECT_EQ(cv::norm(imageWith(effects), imageWith({}), cv::NORM_INF), 0);
  EXPECT_LT(cv::mean(imageWith(effects, later))[1], 0.8 * cv::mean(imageWith({}))[1]);
}

TEST(ViewStudio, KeepsCameraAndPanelWhereTheViewHasThem) {
  EffectParameters<double> effects;
  effects.add<CameraMisalignment>({3, 2, 1});
  effects.add<PanelMoved>({0, 0.2, 0.1, 0.1, 5});
  const cv::Mat with = imageWith(effects), nominal = imageWith({});
  EXPECT_LT(cv::norm(with, nominal, cv::NORM_L1) / static_cast<double>(nominal.total()), 0.01);
}

TEST(CameraView, AViewIsFoundFromItsPose) {
  for (std::uint64_t k = 0; k < 20; ++k) {
    const CameraView view = drawView({}, 3, k);
    const Pose pose = viewOf(view.T_panel_camera()).T_panel_camera();
    EXPECT_NEAR((pose.position - view.T_panel_camera().position).norm(), 0, 1e-12);
    EXPECT_NEAR(angleBetween(pose.rotation, view.T_panel_camera().rotation), 0, 1e-7);
  }
  EXPECT_THROW(viewOf(Pose{}), std::invalid_argument);
}

}  // namespace
}  // namespace fathom
