// Cameras and ports from views whose light was traced by other equations.
#include <gtest/gtest.h>

#include <array>

#include "calibration/camera_selection.h"
#include "support/board_views.h"

namespace fathom {
namespace {

CameraValues truthOf(const test::BoardViews& camera) {
  const CameraModel& l = camera.lens;
  CameraValues truth = CameraValues::Zero();
  truth.head<9>() << l.fx_px, l.fy_px, l.cx_px, l.cy_px, l.k1, l.k2, l.p1, l.p2, l.k3;
  if (camera.port)
    truth.segment<3>(12) << camera.port->distance_m, degrees(camera.port->tilt_x_rad),
        degrees(camera.port->tilt_y_rad);
  if (camera.dome) truth.segment<4>(15) << camera.dome->centre_m, camera.dome->log_radius;
  return truth;
}

/// 4 sigmas: one of twenty numbers is beyond by chance once in 800.
void expectFound(const CameraFit& fit, const CameraValues& truth) {
  for (const std::size_t unknown : fit.unknowns) {
    const auto i = static_cast<Eigen::Index>(unknown);
    EXPECT_NEAR(fit.values[i], truth[i], 4 * fit.sigmaOf(unknown)) << cameraUnknowns()[unknown].name;
  }
}

std::vector<BoardView> airAndWater(const test::BoardViews& camera, int air, int water) {
  std::vector<BoardView> views = camera.views(air, false, 1);
  const std::vector<BoardView> wet = camera.views(water, true, 1);
  views.insert(views.end(), wet.begin(), wet.end());
  return views;
}

test::BoardViews behindAFlatPort() {
  test::BoardViews camera;
  camera.port = FlatPort<double>{true, 0.03, 0.005, radians(1), radians(-0.5), kWaterIndex - 1, 0, 0, 0};
  return camera;
}
test::BoardViews behindADome() {
  test::BoardViews camera;
  camera.dome = DomePort<double>{true, {0.004, -0.003, -0.012}, 0.1, 0.005};
  return camera;
}

TEST(CameraCalibration, FindsALens) {
  const test::BoardViews camera;
  const CameraFit fit = fitCamera(camera.views(20, false, 1), *findCameraKind("pinhole"), camera.setting());
  expectFound(fit, truthOf(camera));
  EXPECT_NEAR(fit.sigma_px, camera.noise_px, 0.05 * camera.noise_px);
  EXPECT_LT(fit.sigmaOf(0), 1);
}

TEST(CameraCalibration, FindsPorts) {
  for (const auto& [camera, kind] :
       {std::pair{behindAFlatPort(), "flat-port"}, std::pair{behindADome(), "dome-port"}}) {
    const CameraFit fit = fitCamera(airAndWater(camera, 15, 15), *findCameraKind(kind), camera.setting());
    expectFound(fit, truthOf(camera));
    EXPECT_NEAR(fit.sigma_px, camera.noise_px, 0.05 * camera.noise_px) << kind;
  }
}

/// As one who has only dived with it.
TEST(CameraCalibration, FindsAPortUnderWaterAlone) {
  const test::BoardViews camera = behindAFlatPort();
  const CameraFit fit = fitCamera(camera.views(25, true, 2), *findCameraKind("flat-port"), camera.setting());
  expectFound(fit, truthOf(camera));
}

TEST(CameraCalibration, LeavesOutliersOut) {
  const test::BoardViews camera;
  std::vector<BoardView> views = camera.views(15, false, 3);
  for (BoardView& view : views) view.pixels[3] += Vector2d(3, -2);
  const CameraFit fit = fitCamera(views, *findCameraKind("pinhole"), camera.setting());
  EXPECT_EQ(fit.outliers, views.size());
  expectFound(fit, truthOf(camera));
}

/// A view's points are off together where the board is not what it is said to be: sigmas say so.
TEST(CameraCalibration, SigmasKnowWhatViewsHaveInCommon) {
  const test::BoardViews camera;
  std::vector<BoardView> views = camera.views(20, false, 4);
  const CameraFit plain = fitCamera(views, *findCameraKind("pinhole"), camera.setting());
  Random random(5);
  for (BoardView& view : views) {
    const double stretched = 1 + 0.001 * random.normal();
    for (Vector3d& point : view.points_m) point.x() *= stretched;
  }
  const CameraFit fit = fitCamera(views, *findCameraKind("pinhole"), camera.setting());
  expectFound(fit, truthOf(camera));
  // By independent points it would be as the root of the residuals' squares.
  EXPECT_GT(fit.sigmaOf(0) / plain.sigmaOf(0), 1.5 * fit.sigma_px / plain.sigma_px);
}

TEST(CameraCalibration, ChoosesThePortThatIsThere) {
  // A lens by itself makes up for much of this dome, but for hardly anything of the flat port.
  for (const auto& [camera, kind, worse] :
       {std::tuple{behindAFlatPort(), "flat-port", 1.2}, std::tuple{behindADome(), "dome-port", 1.01}}) {
    const CameraSelection selection = selectCamera(airAndWater(camera, 12, 15), camera.setting(), {});
    const KindResult& chosen = selection.kinds[selection.chosen];
    EXPECT_EQ(chosen.fit.kind->id, kind);
    EXPECT_NEAR(chosen.heldout_rms_px, camera.noise_px * std::sqrt(2), 0.2 * camera.noise_px);
    // Two halves of some eight numbers: a chi-square of few degrees.
    EXPECT_LT(chosen.halves_px, 2.5 * chosen.halves_sigma_px) << kind;
    EXPECT_GT(chosen.halves_px, 0.3 * chosen.halves_sigma_px) << kind;
    EXPECT_GT(selection.opencv_heldout_rms_px, worse * chosen.heldout_rms_px) << kind;
  }
}

TEST(CameraCalibration, ChoosesNoPortInAir) {
  const test::BoardViews camera;
  const CameraSelection selection = selectCamera(camera.views(15, false, 6), camera.setting(), {});
  EXPECT_EQ(selection.kinds[selection.chosen].fit.kind->id, "pinhole");
  EXPECT_NEAR(selection.opencv_heldout_rms_px, selection.kinds[0].heldout_rms_px, 0.01 * camera.noise_px);
}

TEST(CameraCalibration, AsksForViews) {
  const test::BoardViews camera;
  EXPECT_THROW(fitCamera(camera.views(2, false, 1), *findCameraKind("pinhole"), camera.setting()),
               std::invalid_argument);
  SelectionOptions options;
  options.kinds = {"dome-port"};
  EXPECT_THROW(selectCamera(camera.views(15, false, 1), camera.setting(), options), std::invalid_argument);
  options.kinds = {"pin-hole"};
  EXPECT_THROW(selectCamera(camera.views(15, false, 1), camera.setting(), options), std::invalid_argument);
}

/// Of cameras that differ by where their frame is and nothing else, nothing is left.
TEST(Projection, ATurnedCameraIsTheSame) {
  const test::BoardViews camera = behindAFlatPort();
  const CameraFit fit = fitCamera(airAndWater(camera, 5, 5), *findCameraKind("flat-port"), camera.setting());
  CameraFit moved = fit;
  moved.values[2] += 5;  // like a turn by a quarter of a degree, but for what the lens makes of it
  const ProjectionGrid grid = gridOver(camera.setting(), 1, false);
  for (const Vector2d& off : projectionDifference(fit, fit, grid)) EXPECT_LT(off.norm(), 1e-6);
  double largest = 0;
  for (const Vector2d& off : projectionDifference(fit, moved, grid)) largest = std::max(largest, off.norm());
  EXPECT_LT(largest, 2.5);
  EXPECT_GT(largest, 0.1);
}

}  // namespace
}  // namespace fathom
