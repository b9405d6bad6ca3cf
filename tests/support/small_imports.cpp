#include "support/small_imports.h"

#include <cmath>
#include <utility>

#include "core/geometry.h"
#include "core/text.h"
#include "support/bags.h"
#include "support/panels.h"
#include "support/videos.h"

namespace fathom::test {
namespace fs = std::filesystem;
namespace {

constexpr double kForward_m_s = 1.5, kTurn_rad_s = 0.05;
constexpr double kHeave_m = 0.2, kHeave_rad_s = 0.3;
constexpr double kLatitude_rad = 0.57, kLongitude_rad = 0.61, kEarthRadius_m = 6.37e6;

double velocityDown(double t) { return -kHeave_m * kHeave_rad_s * std::cos(kHeave_rad_s * t); }
double accelerationDown(double t) {
  return kHeave_m * kHeave_rad_s * kHeave_rad_s * std::sin(kHeave_rad_s * t);
}

/// Specific force and rate, forward, right, down.
std::string imuRow(double t) {
  return print("%.4f,0,%.6f,%.6f,0,0,%.6f\n", t, kForward_m_s * kTurn_rad_s, -9.8 + accelerationDown(t),
               kTurn_rad_s);
}
std::string dvlRow(double t) { return print("%.4f,%.6f,0,%.6f\n", t, kForward_m_s, velocityDown(t)); }
std::string solutionRow(double t) {
  const double yaw = kTurn_rad_s * t, radius_m = kForward_m_s / kTurn_rad_s;
  const double north_m = radius_m * std::sin(yaw), east_m = radius_m * (1 - std::cos(yaw));
  return print("%.4f,%.12f,%.12f,%.6f,%.6f,%.6f,%.6f,0,0,%.6f\n", t,
               kLongitude_rad + east_m / (kEarthRadius_m * std::cos(kLatitude_rad)),
               kLatitude_rad + north_m / kEarthRadius_m, -20 + kHeave_m * std::sin(kHeave_rad_s * t),
               kForward_m_s * std::cos(yaw), kForward_m_s * std::sin(yaw), velocityDown(t), yaw);
}

template <class Row>
std::string rows(int count, double rate_hz, Row&& row) {
  std::string text;
  for (int k = 0; k < count; ++k) text += row(k / rate_hz);
  return text;
}

constexpr double kFocal_px = 500, kCentreU_px = 320, kCentreV_px = 240, kWindow_cm = 20;

/// Where a camera at x_cm, which looks along z, sees a point.
Vector2d pixelAt(double x_cm, const Vector3d& point_cm) {
  return {kCentreU_px + kFocal_px * (point_cm.x() - x_cm) / point_cm.z(),
          kCentreV_px + kFocal_px * point_cm.y() / point_cm.z()};
}

std::string cameraBeforeWindow(double x_cm) {
  std::string text =
      print("fx_px: %g\nfy_px: %g\ncx_px: %g\ncy_px: %g\ndistortion: [0, 0, 0, 0]\nreference_corners:\n",
            kFocal_px, kFocal_px, kCentreU_px, kCentreV_px);
  for (const auto& [x, y] : {std::pair{-8, -6}, {8, -6}, {8, 6}, {-8, 6}}) {
    const Vector3d corner_cm(x_cm + x, y, kWindow_cm);
    const Vector2d pixel = pixelAt(x_cm, corner_cm);
    text += print("  - {u_px: %g, v_px: %g, x_cm: %g, y_cm: %g, z_cm: %g}\n", pixel.x(), pixel.y(),
                  corner_cm.x(), corner_cm.y(), corner_cm.z());
  }
  return text;
}

}  // namespace

void writeSmallBag(const fs::path& folder) {
  rosbag::Bag bag((folder / "Bandaufnahme ä.bag").string(), rosbag::bagmode::Write);
  for (unsigned k = 1; k <= 400; ++k) bag.write("/imu", rosTime(k), imuMessage(rosTime(k)));
  bag.close();
  writeNew(folder / "Themen ö.yaml",
           "topics:\n  - {topic: /imu, as: INS,\n"
           "     pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}}\n");
}

void writeSmallCorners(const fs::path& folder) {
  std::string text = "image,corner,u_px,v_px\n";
  for (int view = 0; view < 3; ++view)
    for (int k = 0; k < 9; ++k)
      text += print("Bild %d.png,%d,%d,%d\n", view, k, 200 + 30 * (k % 3) + 5 * view, 150 + 30 * (k / 3));
  writeNew(folder / "Ecken é.csv", text);
  writeNew(folder / "Kamera 1.yaml", "fx_px: 500\nfy_px: 500\ncx_px: 319.5\ncy_px: 239.5\n");
}

void writeSmallBoard(const fs::path& folder) {
  std::string text = "image,corner,u_px,v_px\n";
  for (int view = 0; view < 8; ++view) {
    const Matrix3d turned =
        expSO3<double>(Vector3d(0.4 * std::sin(view), 0.4 * std::cos(2 * view), 0.2 * view));
    for (int k = 0; k < 12; ++k) {
      const Vector3d point =
          turned * Vector3d(0.05 * (k % 4), 0.05 * (k / 4), 0) + Vector3d(-0.1, -0.05, 0.5);
      text += print("Bild %d.png,%d,%.4f,%.4f\n", view, k,
                    500 * point.x() / point.z() + 319.5 + 0.1 * std::sin(7 * k + view),
                    500 * point.y() / point.z() + 239.5 + 0.1 * std::cos(9 * k + 2 * view));
    }
  }
  writeNew(folder / "Schachbrett ü.csv", text);
}

void writeSmallSeaTrial(const fs::path& folder) {
  const fs::path tables = folder / "Tabellen ö";
  fs::create_directories(tables);
  writeNew(tables / "IMU_trajectory1.csv",
           "Time [s],ACC X [m/s^2],ACC Y [m/s^2],ACC Z [m/s^2],GYRO X [rad/s],GYRO Y [rad/s],"
           "GYRO Z [rad/s]\n" +
               rows(601, 10, imuRow));
  writeNew(tables / "DVL_trajectory1.csv",
           "Time [s],DVL X [m/s],DVL Y [m/s],DVL Z [m/s]\n" + rows(61, 1, dvlRow));
  writeNew(tables / "GT_trajectory1.csv",
           "Time [s],Longitude [rad],Latitude [rad],Altitude [m],V North [m/s],V East [m/s],"
           "V Down [m/s],Roll [rad],Pitch [rad],Yaw [rad]\n" +
               rows(61, 1, solutionRow));
}

void writeSmallTiePoints(const fs::path& folder) {
  constexpr double kRight_cm = 10;
  std::string text = "camera,frame,id,u_px,v_px\n";
  for (int frame = 0; frame < 3; ++frame)
    for (int id = 0; id < 6; ++id) {
      const Vector3d point_cm(-4 + 3 * id, 2 * (id % 3) - 2, 60 + 3 * frame + id);
      for (int camera = 1; camera <= 2; ++camera) {
        const Vector2d pixel = pixelAt(camera == 1 ? 0 : kRight_cm, point_cm);
        text += print("%d,%d,%d,%.2f,%.2f\n", camera, frame, id, pixel.x(), pixel.y());
      }
    }
  writeNew(folder / "Punkte ä.csv", text);
  writeNew(folder / "Kamera links.yaml", cameraBeforeWindow(0));
  writeNew(folder / "Kamera rechts.yaml", cameraBeforeWindow(kRight_cm));
}

void writeSmallVideo(const fs::path& folder) {
  constexpr int kFrames = 5;
  writeVideo(folder / "Film ö.avi", "MJPG", kFrames);
  std::string text = "stamp\n";
  for (int k = 0; k < kFrames; ++k) text += print("2024-05-06T07:08:09.%02dZ\n", 4 * k);
  writeNew(folder / "Stempel ü.csv", text);
}

}  // namespace fathom::test
