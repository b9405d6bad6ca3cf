// Lenses, against OpenCV's.
#include "core/camera_model.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "core/files.h"
#include "sensors/vehicle.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {

CameraModel wideCamera(LensModel lens) {
  CameraModel camera{1280, 720, 560, 558, 640, 360};
  camera.lens = lens;
  camera.k1 = -0.029, camera.k2 = 0.021, camera.k3 = -0.012, camera.k4 = 0.007;
  if (lens != LensModel::fisheye) camera.p1 = 0.001, camera.p2 = -0.002;
  if (lens == LensModel::rational) camera.k5 = 0.003, camera.k6 = 0.0004;
  if (lens == LensModel::plumb_bob) camera.k4 = 0;
  return camera;
}

cv::Point2d byOpenCv(const CameraModel& c, const Vector3d& point) {
  const cv::Matx33d K(c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
  const std::vector<cv::Point3d> points{{point.x(), point.y(), point.z()}};
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d zero(0, 0, 0);
  if (c.lens == LensModel::fisheye)
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, std::vector<double>{c.k1, c.k2, c.k3, c.k4});
  else
    cv::projectPoints(points, zero, zero, K,
                      std::vector<double>{c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6}, pixels);
  return pixels[0];
}

class Lenses : public testing::TestWithParam<LensModel> {};

/// To 45 degrees off the axis; of a fisheye to 80. Both compute in doubles: 1e-9 px is rounding.
TEST_P(Lenses, ProjectAsOpenCvAndBack) {
  const CameraModel camera = wideCamera(GetParam());
  const double widest = GetParam() == LensModel::fisheye ? 80 : 45;  // of the others, where these fold
  for (double off_deg = 0; off_deg <= widest; off_deg += 5)
    for (double around_deg = 0; around_deg < 360; around_deg += 45) {
      const double r = std::tan(radians(off_deg));
      const Vector3d point(2 * r * std::cos(radians(around_deg)), 2 * r * std::sin(radians(around_deg)), 2);
      const Vector2d pixel = camera.project(point);
      const cv::Point2d expected = byOpenCv(camera, point);
      EXPECT_NEAR(pixel.x(), expected.x, 1e-9) << off_deg;
      EXPECT_NEAR(pixel.y(), expected.y, 1e-9) << off_deg;
      EXPECT_LT((camera.idealAt(pixel) - point.head<2>() / point.z()).norm(), 1e-9 * (1 + r * r)) << off_deg;
    }
}

TEST_P(Lenses, HaveTheDerivativesOfDifferences) {
  using Jet = ceres::Jet<double, 3>;
  const CameraModel camera = wideCamera(GetParam());
  for (const Vector3d& p : {Vector3d(0, 0, 1), Vector3d(1e-9, 0, 1), Vector3d(0.3, -0.2, 1.1)}) {
    const Vector2<Jet> pixel = camera.project(Vector3<Jet>(Jet(p.x(), 0), Jet(p.y(), 1), Jet(p.z(), 2)));
    for (int i = 0; i < 3; ++i) {
      const double h = 1e-6;
      const Vector2d slope = (camera.project(Vector3d(p + h * Vector3d::Unit(i))) -
                              camera.project(Vector3d(p - h * Vector3d::Unit(i)))) /
                             (2 * h);
      EXPECT_NEAR(pixel.x().v[i], slope.x(), 1e-5);
      EXPECT_NEAR(pixel.y().v[i], slope.y(), 1e-5);
    }
  }
}

TEST_P(Lenses, StandInVehicleFiles) {
  const CameraModel camera = wideCamera(GetParam());
  std::string rov = readTextFile(test::kRov);
  const std::size_t from = rov.find("distortion: {") + 13, to = rov.find('}', from);
  rov.replace(from, to - from, distortionText(camera));
  const auto file = test::scratchFolder() / "vehicle.yaml";
  writeTextFile(file, rov);
  const CameraModel read = readVehicle(file).camera.value().model;
  EXPECT_EQ(read.lens, camera.lens);
  for (const LensCoefficient& c : coefficientsOf(camera.lens))
    EXPECT_EQ(read.*c.value, camera.*c.value) << c.name;
}

INSTANTIATE_TEST_SUITE_P(CameraModel, Lenses,
                         testing::Values(LensModel::plumb_bob, LensModel::rational, LensModel::fisheye),
                         [](const auto& info) { return std::string(nameOf(info.param)); });

}  // namespace
}  // namespace fathom
