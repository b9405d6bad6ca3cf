// Station keeping, surveys and recorded poses as kinds of trajectory files.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "core/files.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "sensors/vehicle.h"
#include "simulation/read_trajectory.h"
#include "support/motions.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const fs::path kConfigFolder = fs::path(FATHOM_SOURCE_DIR) / "config";

Trajectory kindFromText(const std::string& text) {
  const auto file = test::scratchFolder() / "path.yaml";
  writeTextFile(file, text);
  return readTrajectory(file);
}

std::string trajectoryComplaint(const std::string& text) {
  try {
    kindFromText(text);
  } catch (const Error& error) {
    return error.where + ": " + error.why;
  }
  return "none";
}

double yawOf(const KinematicState<double>& state) {
  return std::atan2(state.R_odom_robot(1, 0), state.R_odom_robot(0, 0));
}

/// Position, velocity and attitude go on without a jump, also where knots and legs meet.
void expectContinuous(const Trajectory& trajectory, double largest_speed_m_s) {
  const double dt = 0.01;
  auto before = trajectory.at(trajectory.start_s());
  for (const double t : test::timesBetween(trajectory.start_s() + dt, trajectory.end_s(), dt)) {
    const auto now = trajectory.at(t);
    ASSERT_LT((now.position_odom - before.position_odom).norm(), largest_speed_m_s * dt * 1.01) << t;
    ASSERT_LT((now.R_odom_robot * now.velocity_robot - before.R_odom_robot * before.velocity_robot).norm(),
              0.5 * dt)
        << t;
    ASSERT_LT(angleBetween(now.R_odom_robot, before.R_odom_robot), radians(25) * dt) << t;
    before = now;
  }
}

const std::string kStation =
    "kind: station\npose: {x: 3.5, y: 0.2, z: -4.5, yaw_deg: 10}\nduration_s: 60\nsway:\n"
    "  - {axis: x, amplitude_m: 0.05, period_s: 9}\n  - {axis: y, amplitude_m: 0.08, period_s: 7}\n"
    "  - {axis: yaw, amplitude_deg: 2, period_s: 5}\n";

TEST(Station, KeepsItsPoseWithinTheSway) {
  const Trajectory trajectory = kindFromText(kStation + "sway_seed: 3\n");
  EXPECT_NEAR(trajectory.end_s(), 60, 0.2);
  Vector3d largest = Vector3d::Zero();
  double largest_yaw = 0;
  for (const double t : test::timesBetween(0, 60, 0.1)) {
    const auto state = trajectory.at(t);
    largest = largest.cwiseMax((state.position_odom - Vector3d(3.5, 0.2, -4.5)).cwiseAbs());
    largest_yaw = std::max(largest_yaw, std::abs(yawOf(state) - radians(10)));
  }
  // It moves by what was asked for: no more, and no less than a few knots per period let the spline lose.
  EXPECT_LT((largest - Vector3d(0.05, 0.08, 0)).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_NEAR(largest_yaw, radians(2), radians(0.05));
  expectContinuous(trajectory, 0.11);  // 2 pi (0.05/9 and 0.08/7, together)
}

TEST(Station, PhasesComeFromTheSeed) {
  const auto at30s = [](const std::string& more) {
    return kindFromText(kStation + more).at(30.0).position_odom;
  };
  EXPECT_EQ(at30s("sway_seed: 3\n"), at30s("sway_seed: 3\n"));
  EXPECT_GT((at30s("sway_seed: 3\n") - at30s("sway_seed: 4\n")).norm(), 1e-3);
  EXPECT_GT((at30s("sway_seed: 3\n") - at30s("")).norm(), 1e-3);
}

const std::string kSurvey =
    "kind: survey\ntarget: {x: 6, y: 1, z: -4.6}\nheading_deg: 90\ndistances_m: [3, 1.5]\nlength_m: 2\n"
    "extent_m: 0.9\nspacing_m: 0.4\nspeed_m_s: 0.25\nturn_rate_deg_s: 12\n";

TEST(Survey, SweepsThePlanesBeforeTheTarget) {
  const Trajectory trajectory = kindFromText(kSurvey);
  expectContinuous(trajectory, 0.25);
  // Heading 90: the vehicle looks along y, so sweeps stand at y = 1 - 3 and 1 - 1.5 and legs go along x.
  const auto begin = trajectory.at(trajectory.start_s()), end = trajectory.at(trajectory.end_s());
  EXPECT_LT((begin.position_odom - Vector3d(7, -2, -4.15)).norm(), 1e-6);
  // Four legs 0.3 m apart; the second sweep comes back up from the lowest leg and ends where it began.
  EXPECT_LT((end.position_odom - Vector3d(7, -0.5, -4.15)).norm(), 1e-3);
  Vector3d low = begin.position_odom, high = low;
  for (const double t : test::timesBetween(trajectory.start_s(), trajectory.end_s(), 0.1)) {
    const auto state = trajectory.at(t);
    low = low.cwiseMin(state.position_odom);
    high = high.cwiseMax(state.position_odom);
    ASSERT_NEAR(yawOf(state), radians(90), 1e-9);
    ASSERT_LT(state.velocity_robot.norm(), 0.25 * 1.001);
  }
  EXPECT_LT((low - Vector3d(5, -2, -5.05)).norm(), 1e-3);
  EXPECT_LT((high - Vector3d(7, -0.5, -4.15)).norm(), 1e-3);
}

TEST(Survey, FacesItsTarget) {
  const Trajectory trajectory = kindFromText(kSurvey + "facing: target\n");
  expectContinuous(trajectory, 0.25);
  double largest_rad = 0, fastest_rad_s = 0;
  for (const double t : test::timesBetween(trajectory.start_s(), trajectory.end_s(), 0.1)) {
    const auto state = trajectory.at(t);
    const Vector3d look = Vector3d(6, 1, -4.6) - state.position_odom;
    largest_rad = std::max(largest_rad, std::abs(wrapAngle(yawOf(state) - std::atan2(look.y(), look.x()))));
    fastest_rad_s = std::max(fastest_rad_s, state.angular_velocity_robot.norm());
  }
  // Even turning against the true direction: 1.6 degrees along a leg (atan(u/1.5) against u atan(1/1.5)), 2.1
  // halfway from one sweep to the next (atan(1/2.25) against the mean of atan(1/3) and atan(1/1.5)).
  EXPECT_NEAR(largest_rad, radians(2.1), radians(0.1));
  EXPECT_LT(fastest_rad_s, radians(12.01));
}

TEST(Survey, GoesOverTheFloorNoseFirst) {
  const Trajectory trajectory = kindFromText(
      "kind: survey\nplane: level\ntarget: {x: 0, y: 0, z: -6}\nheading_deg: 0\ndistances_m: [2]\nlength_m: "
      "6\n"
      "extent_m: 4\nspacing_m: 2\nfacing: legs\nspeed_m_s: 0.5\n");
  expectContinuous(trajectory, 0.5);
  int moving = 0;
  for (const double t : test::timesBetween(trajectory.start_s(), trajectory.end_s(), 0.1)) {
    const auto state = trajectory.at(t);
    ASSERT_NEAR(state.position_odom.z(), -4, 1e-6);
    if (state.velocity_robot.norm() < 0.05) continue;
    ++moving;
    ASSERT_GT(state.velocity_robot.x(), 0.99 * state.velocity_robot.norm()) << t;  // spline at corners
  }
  EXPECT_GT(moving, 400);  // 22 m at 0.5 m/s
  EXPECT_LT((trajectory.at(trajectory.start_s()).position_odom - Vector3d(-3, -2, -4)).norm(), 1e-6);
}

TEST(Recorded, GoesWhereTheRecordingWent) {
  const auto folder = test::scratchFolder();
  const Trajectory original = test::sineTrajectory(20, 0.1);
  RawlogWriter rawlog(folder / "r.rawlog", {}, fromUnixSeconds(1e9));
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 200; ++i) {
    const auto state = original.at(0.1 * i);
    poses.push_back({after(fromUnixSeconds(1e9), 0.1 * i), {state.R_odom_robot, state.position_odom}});
    PoseSample truth;
    truth.T_odom_robot.mean = poses.back().T_odom_robot;
    rawlog.write({poses.back().time, labels::kTruth, truth});
  }
  rawlog.finish();
  writeTum(folder / "r.tum", poses);
  for (const std::string file : {"r.tum", "r.rawlog"}) {
    writeTextFile(folder / "path.yaml", "kind: recorded\nfile: " + file + "\n");
    for (const auto& path : {folder / "path.yaml", folder / file}) {
      const Trajectory again = readTrajectory(path);
      for (const double t : test::timesBetween(1, 19, 0.3))
        EXPECT_LT((again.at(t).position_odom - original.at(t).position_odom).norm(), 1e-5) << path;
    }
  }
}

TEST(Recorded, ARecordingWithoutTruthIsNamed) {
  const auto folder = test::scratchFolder();
  RawlogWriter rawlog(folder / "r.rawlog", {}, fromUnixSeconds(1e9));
  rawlog.write({fromUnixSeconds(1e9), labels::kDvl, DvlSample{}});
  rawlog.finish();
  EXPECT_THROW(readTrajectory(folder / "r.rawlog"), Error);
}

TEST(TrajectoryKinds, MistakesAreNamed) {
  EXPECT_EQ(trajectoryComplaint(kSurvey), "none");
  EXPECT_NE(trajectoryComplaint("kind: circle\n").find("must be waypoints"), std::string::npos);
  EXPECT_NE(trajectoryComplaint("kind: recorded\nfile: absent.tum\n").find("not there"), std::string::npos);
  EXPECT_NE(trajectoryComplaint(kSurvey + "waypoints: []\n").find("waypoints"), std::string::npos);
  EXPECT_NE(trajectoryComplaint(kSurvey + "facing: legs\n").find("level"), std::string::npos);
  EXPECT_NE(trajectoryComplaint(kSurvey + "facing: away\n").find("heading, target or legs"),
            std::string::npos);
  EXPECT_NE(trajectoryComplaint(kStation + "speed_m_s: 1\n").find("speed_m_s"), std::string::npos);
  EXPECT_NE(trajectoryComplaint("kind: station\npose: {x: 0, y: 0, z: 0, yaw_deg: 0}\nduration_s: 1e9\n")
                .find("30 days"),
            std::string::npos);
  EXPECT_NE(trajectoryComplaint("kind: station\npose: {x: 0, y: 0, z: 0, yaw_deg: 0}\nduration_s: 1\n")
                .find("at least"),
            std::string::npos);
}

/// Markers whose corners all lie in the image.
int markersInView(const PanelMap& map, const CameraSheet& camera, const Pose& T_odom_robot) {
  const Pose T_camera_panel = (T_odom_robot * camera.T_robot_camera).inverse() * map.T_odom_panel;
  return static_cast<int>(std::count_if(map.markers.begin(), map.markers.end(), [&](const Marker& marker) {
    const auto corners = marker.corners_panel();
    return std::all_of(corners.begin(), corners.end(), [&](const Vector3d& corner) {
      const Vector3d point = T_camera_panel * corner;
      return point.z() > 0 && camera.model.contains(camera.model.project(point));
    });
  }));
}

// The shipped examples fly where the shipped vehicle's camera sees the shipped panel.
TEST(TrajectoryKinds, ShippedOnesLookAtThePanel) {
  const PanelMap map = readPanelMap(fs::path(FATHOM_SOURCE_DIR) / "maps/dexrov/panel.yaml");
  const CameraSheet camera = readVehicle(kConfigFolder / "rov.yaml").camera.value();
  for (const char* name : {"trajectory_station.yaml", "trajectory_survey.yaml"}) {
    const Trajectory trajectory = readTrajectory(kConfigFolder / name);
    expectContinuous(trajectory, 0.45);
    int seen = 0, all = 0;
    for (const double t : test::timesBetween(trajectory.start_s(), trajectory.end_s(), 0.5)) {
      const auto state = trajectory.at(t);
      const Pose T_odom_robot{state.R_odom_robot, state.position_odom};
      const Pose T_panel_camera = map.T_odom_panel.inverse() * T_odom_robot * camera.T_robot_camera;
      EXPECT_GT(T_panel_camera.position.z(), 1.15) << name;  // distance to the face
      EXPECT_LT(T_panel_camera.position.z(), 4.0) << name;
      seen += markersInView(map, camera, T_odom_robot) >= 4 ? 1 : 0;
      ++all;
    }
    EXPECT_GT(seen, 0.95 * all) << name;
  }
}

}  // namespace
}  // namespace fathom
