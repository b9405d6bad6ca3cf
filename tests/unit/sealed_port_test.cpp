// The sealed generator's camera: rays through a window against the closed form, and back.
#include <gtest/gtest.h>

#include <cmath>

#include "sealed/port.h"
#include "sealed/viewpoint.h"
#include "support/sealed_example.h"

namespace fathom::sealed {
namespace {

constexpr const char* kTiltedPort =
    R"([{"id": "flat-port-refraction",
         "parameters": {"distance_m": 0.03, "glass_m": 0.01, "tilt_deg": 1.5, "tilt_y_deg": -0.7}}])";

TEST(SealedPort, RaysAreBentByTheClosedForm) {
  const SealedCase sealed = exampleCase(kTiltedPort);
  const TrueCamera camera(Camera{}, sealed, 0);
  const Vector3d normal = expSO3<double>(Vector3d(radians(1.5), radians(-0.7), 0)).col(2);
  const TrueCamera without_port(Camera{}, exampleCase(), 0);
  for (const Vector2d& pixel :
       {Vector2d(20, 30), Vector2d(600, 100), Vector2d(321, 245), Vector2d(80, 460)}) {
    const Vector3d calibrated = without_port.rayAt(pixel).direction;
    const double sine_water = normal.cross(calibrated).norm(), sine_air = 1.34 * sine_water;
    const auto tangent = [](double sine) { return sine / std::sqrt(1 - sine * sine); };
    const Ray ray = camera.rayAt(pixel);
    for (const double height_m : {0.1, 1.0, 3.0}) {
      const Vector3d point =
          ray.origin + ray.direction * ((height_m - ray.origin.dot(normal)) / ray.direction.dot(normal));
      const double expected_m =
          0.03 * tangent(sine_air) + 0.01 * tangent(sine_air / 1.5) + (height_m - 0.04) * tangent(sine_water);
      EXPECT_NEAR((point - height_m * normal).norm(), expected_m, 1e-12);
      EXPECT_NEAR(point.dot(normal.cross(calibrated)), 0, 1e-12);  // in the plane of incidence
    }
  }
}

TEST(SealedPort, PointsAreSeenWhereTheirRaysStart) {
  const SealedCase sealed = exampleCase(kTiltedPort);
  const TrueCamera camera(Camera{}, sealed, 0);
  for (const Vector2d& pixel : {Vector2d(5, 7), Vector2d(630, 470), Vector2d(320, 240)})
    for (const double height_m : {0.3, 2.0}) {
      const auto seen = camera.pixelOf(camera.rayAt(pixel).atHeight(height_m));
      ASSERT_TRUE(seen);
      EXPECT_NEAR((*seen - pixel).norm(), 0, 1e-8);
    }
}

TEST(SealedPort, AWindowAtTheCameraIsInTheIntrinsics) {
  const SealedCase sealed =
      exampleCase(R"([{"id": "flat-port-refraction", "parameters": {"distance_m": 0, "glass_m": 0}}])");
  const TrueCamera camera(Camera{}, sealed, 0), nominal(Camera{}, exampleCase(), 0);
  const Vector3d point(0.4, -0.3, 1.2);
  EXPECT_NEAR((*camera.pixelOf(point) - *nominal.pixelOf(point)).norm(), 0, 1e-9);
}

TEST(SealedPort, WhatIsFarBesideTheImageIsNotInIt) {
  const TrueCamera camera(Camera{}, exampleCase(), 0);
  for (double slope = 0.75; slope < 5; slope += 0.01) {
    const auto pixel = camera.pixelOf(Vector3d(slope, 0, 1));
    EXPECT_TRUE(!pixel || pixel->x() > 640) << slope;
  }
}

TEST(SealedPort, ARowSeesThePanelAtItsOwnTime) {
  const SealedCase sealed = exampleCase(R"([{"id": "rolling-shutter", "parameters": {"readout_s": 0.05}}])");
  const Vehicle vehicle;
  const Dive dive = makeDive("rich", 3, {6, 0, -4.2});
  const Viewpoint viewpoint(vehicle, sealed, dive);
  const TrueCamera camera(vehicle.camera, sealed, 2.0);
  const Vector3d point_odom(6, 0.1, -4.3);
  const auto pixel = viewpoint.pixelOf(camera, point_odom, 2.0);
  ASSERT_TRUE(pixel);
  const double row_time_s = 2.0 + 0.05 * pixel->y() / 480;
  const auto then = camera.pixelOf(viewpoint.T_odom_camera(row_time_s, 2.0).inverse() * point_odom);
  EXPECT_NEAR((*then - *pixel).norm(), 0, 1e-6);
}

}  // namespace
}  // namespace fathom::sealed
