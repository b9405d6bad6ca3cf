#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "simulation/read_trajectory.h"
#include "support/motions.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

Trajectory fromText(const std::string& text) {
  const auto file = test::scratchFolder() / "way.yaml";
  writeTextFile(file, text);
  return readTrajectory(file);
}

void expectAt(const Trajectory& trajectory, double time_s, const Vector3d& position, double yaw_deg) {
  const auto state = trajectory.at(time_s);
  // Between knots 0.2 s apart the spline leaves the planned path by far less than 0.1 mm.
  EXPECT_LT((state.position_odom - position).norm(), 1e-4) << time_s;
  EXPECT_LT(angleBetween(state.R_odom_robot, rotationFromYawPitchRoll(radians(yaw_deg), 0, 0)), 1e-4)
      << time_s;
}

TEST(Waypoints, KeepsItsTimesPlacesAndSpeeds) {
  const Trajectory trajectory = fromText(R"(
speed_m_s: 0.5
turn_rate_deg_s: 30
ramp_s: 2
waypoints:
  - {x: 1, y: 2, z: -3, yaw_deg: 0, hold_s: 4}
  - {x: 6, y: 2, z: -3, yaw_deg: 0, hold_s: 3}
  - {x: 6, y: 2, z: -3, yaw_deg: 360}
  - {x: 6, y: 3, z: -4, yaw_deg: 360, t_s: 50, hold_s: 10}
)");
  // 4 s hold; 5 m at 0.5 m/s and a ramp: 12 s; 3 s hold; a turn of 12 s and a ramp: 14 s; arrival at 50 s.
  expectAt(trajectory, 4, {1, 2, -3}, 0);
  expectAt(trajectory, 10, {3.5, 2, -3}, 0);
  EXPECT_NEAR(trajectory.at(10.0).velocity_robot.x(), 0.5, 1e-4);
  expectAt(trajectory, 16, {6, 2, -3}, 0);
  expectAt(trajectory, 19, {6, 2, -3}, 0);
  expectAt(trajectory, 26, {6, 2, -3}, 180);
  EXPECT_NEAR(trajectory.at(26.0).angular_velocity_robot.z(), radians(30), 1e-4);
  expectAt(trajectory, 33, {6, 2, -3}, 0);
  expectAt(trajectory, 50, {6, 3, -4}, 0);
  EXPECT_NEAR(trajectory.end_s(), 60, 0.2);
}

TEST(Waypoints, BeginsAndEndsAtRestAlsoWithSway) {
  const Trajectory trajectory = fromText(R"(
waypoints:
  - {x: 0, y: 0, z: -3, yaw_deg: 10, hold_s: 60}
sway:
  - {axis: z, amplitude_m: 0.1, period_s: 6}
  - {axis: roll, amplitude_deg: 3, period_s: 4, phase_deg: 90}
)");
  for (const double t : {trajectory.start_s(), trajectory.end_s()}) {
    const auto state = trajectory.at(t);
    EXPECT_LT(state.velocity_robot.norm(), 1e-6);
    EXPECT_LT(state.angular_velocity_robot.norm(), 1e-6);
    EXPECT_LT((state.position_odom - Vector3d(0, 0, -3)).norm(), 1e-9);
  }
  double lowest = 0, highest = -10, roll = 0;
  for (const double t : test::timesBetween(0, 60, 0.1)) {
    const auto state = trajectory.at(t);
    lowest = std::min(lowest, state.position_odom.z());
    highest = std::max(highest, state.position_odom.z());
    roll = std::max(roll, yawPitchRollFromRotation(state.R_odom_robot)[2]);
  }
  EXPECT_NEAR(lowest, -3.1, 1e-3);
  EXPECT_NEAR(highest, -2.9, 1e-3);
  EXPECT_NEAR(roll, radians(3), 1e-3);
}

TEST(Waypoints, ShippedDiveIsADive) {
  const Trajectory dive =
      readTrajectory(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/dive_trajectory.yaml");
  EXPECT_NEAR(dive.end_s(), 300, 30);
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  double speed = 0, rate = 0, sideways = 0;
  for (const double t : test::timesBetween(0, dive.end_s(), 0.05)) {
    const auto state = dive.at(t);
    low = low.cwiseMin(state.position_odom);
    high = high.cwiseMax(state.position_odom);
    speed = std::max(speed, state.velocity_robot.norm());
    rate = std::max(rate, state.angular_velocity_robot.norm());
    sideways = std::max(sideways, std::abs(state.velocity_robot.y()));
  }
  EXPECT_NEAR(high.x() - low.x(), 12, 0.2);
  EXPECT_GT(high.y() - low.y(), 8);
  EXPECT_GT(low.z(), -5.1);
  EXPECT_LT(high.z(), -2.9);
  EXPECT_LT(speed, 0.75);
  EXPECT_GT(speed, 0.5);
  EXPECT_LT(rate, radians(40));
  EXPECT_GT(sideways, 0.15);
}

struct BadWaypoints {
  const char* what;
  const char* text;
  const char* where;
};
void PrintTo(const BadWaypoints& bad, std::ostream* out) { *out << bad.what; }

class WaypointsRefuse : public testing::TestWithParam<BadWaypoints> {};

TEST_P(WaypointsRefuse, WithFileKeyAndLine) {
  try {
    fromText(GetParam().text);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(error.file.find("way.yaml"), std::string::npos);
    EXPECT_EQ(error.where, GetParam().where) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, WaypointsRefuse,
    testing::Values(
        BadWaypoints{"NoWaypoints", "waypoints: []", "waypoints (line 1)"},
        BadWaypoints{"UnknownKey", "waypoints:\n  - {x: 0, y: 0, z: 0, yaw_deg: 0, hold: 3}",
                     "waypoints[0].hold (line 2)"},
        BadWaypoints{"MissingUnit", "waypoints:\n  - {x: 0, y: 0, z: 0, yaw: 0}",
                     "waypoints[0].yaw (line 2)"},
        BadWaypoints{"StandingSpeed", "speed_m_s: 0\nwaypoints:\n  - {x: 0, y: 0, z: 0, yaw_deg: 0}",
                     "speed_m_s (line 1)"},
        BadWaypoints{
            "TooEarly",
            "waypoints:\n  - {x: 0, y: 0, z: 0, yaw_deg: 0}\n  - {x: 0, y: 1, z: 0, yaw_deg: 0, t_s: 1}",
            "waypoints[1].t_s (line 3)"},
        BadWaypoints{"TimeAndSpeed", "waypoints:\n  - {x: 0, y: 0, z: 0, yaw_deg: 0, t_s: 9, speed_m_s: 1}",
                     "waypoints[0].t_s (line 2)"},
        BadWaypoints{"Axis",
                     "waypoints:\n  - {x: 0, y: 0, z: 0, yaw_deg: 0}\nsway:\n  - {axis: up, period_s: 3}",
                     "sway[0].axis (line 4)"},
        BadWaypoints{
            "AmplitudeUnit",
            "waypoints:\n  - {x: 0, y: 0, z: 0, yaw_deg: 0}\nsway:\n  - {axis: roll, amplitude_m: 1, "
            "period_s: 3}",
            "sway[0] (line 4)"}),
    [](const auto& each) { return each.param.what; });

}  // namespace
}  // namespace fathom
