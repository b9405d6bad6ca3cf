// The sealed generator's navigation sensors against the path they are made from.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "recording/tum.h"
#include "sealed/depth_gauge.h"
#include "sealed/doppler.h"
#include "sealed/given_path.h"
#include "sealed/inertial.h"
#include "support/sealed_example.h"
#include "support/shared_data.h"

namespace fathom::sealed {
namespace {

constexpr double kFloor_m = 6;
const Vector3d kPanel_odom(6, 0, -4.2);

void expectRatesAreDerivatives(const Dive& dive, double t_s) {
  constexpr double kStep_s = 1e-4;
  const Motion before = dive.at(t_s - kStep_s), now = dive.at(t_s), later = dive.at(t_s + kStep_s);
  const Matrix3d turned = before.T_odom_robot.rotation.transpose() * later.T_odom_robot.rotation;
  const auto mean = [&](const Vector3d& a, const Vector3d& b) { return Vector3d((b - a) / (2 * kStep_s)); };
  EXPECT_LT((now.velocity_odom - mean(before.T_odom_robot.position, later.T_odom_robot.position)).norm(),
            1e-7);
  EXPECT_LT((now.acceleration_odom - mean(before.velocity_odom, later.velocity_odom)).norm(), 1e-7);
  EXPECT_LT((now.rate_robot - logSO3<double>(turned) / (2 * kStep_s)).norm(), 1e-7);
  EXPECT_LT((now.angular_acceleration_robot - mean(before.rate_robot, later.rate_robot)).norm(), 1e-7);
}

TEST(SealedDive, RatesAreThePathsDerivatives) {
  for (const char* manoeuvre : {"rich", "survey", "station", "approach", "closing", "turns"})
    for (const double t_s : {0.0, 7.3, 41.9})
      expectRatesAreDerivatives(makeDive(manoeuvre, 5, kPanel_odom), t_s);
}

TEST(SealedDive, ComesNearerAllTheWhile) {
  const Dive dive = makeDive("closing", 5, kPanel_odom);
  for (double t_s = 0; t_s < 30; t_s += 1) EXPECT_GT(dive.at(t_s).velocity_odom.x(), 0.01) << t_s;
}

/// A path as a file, and a dive along it.
class GivenDive : public testing::Test {
 protected:
  void write(const Dive& path, double rate_hz, double duration_s) const {
    std::vector<StampedPose> poses;
    for (int i = 0; i <= duration_s * rate_hz; ++i)
      poses.push_back({fromUnixSeconds(i / rate_hz), path.poseAt(i / rate_hz)});
    writeTum(file_, poses);
  }
  Dive along(const Dive& path, double rate_hz, double duration_s) const {
    write(path, rate_hz, duration_s);
    return makeDive({.manoeuvre = "given", .path = file_, .duration_s = duration_s}, kPanel_odom);
  }
  const std::filesystem::path file_ = test::scratchFolder() / "path.tum";
};

// Turns by far more than half a turn to either side, so that quaternions change their sign.
TEST_F(GivenDive, GoesThroughTheGivenPoses) {
  const Dive path([](double t_s) {
    Motion motion = makeDive("rich", 3, kPanel_odom).at(t_s);
    motion.T_odom_robot.rotation *= expSO3<double>({0, 0, 5 * std::sin(0.3 * t_s)});
    return motion;
  });
  const Dive dive = along(path, 20, 30);
  for (const double t_s : {1.02, 3.02, 11.01, 28.97}) {
    EXPECT_LT((dive.poseAt(t_s).position - path.poseAt(t_s).position).norm(), 1e-5) << t_s;
    EXPECT_LT(angleBetween(dive.poseAt(t_s).rotation, path.poseAt(t_s).rotation), 1e-4) << t_s;
    expectRatesAreDerivatives(dive, t_s);
  }
}

TEST_F(GivenDive, IsContinuousToTheAcceleration) {
  const Dive dive = along(makeDive("rich", 3, kPanel_odom), 10, 30);
  const Motion before = dive.at(12.3 - 1e-9), after = dive.at(12.3 + 1e-9);  // about a given pose
  EXPECT_LT((before.acceleration_odom - after.acceleration_odom).norm(), 1e-6);
  EXPECT_LT((before.angular_acceleration_robot - after.angular_acceleration_robot).norm(), 1e-6);
}

TEST_F(GivenDive, RestsBeforeAndAfter) {
  const Dive dive = along(makeDive("rich", 3, kPanel_odom), 20, 10);
  EXPECT_EQ(dive.poseAt(10.5).position, dive.poseAt(10).position);
  EXPECT_EQ(dive.at(-1).velocity_odom, Vector3d::Zero());
}

TEST_F(GivenDive, SaysWhatIsWrongAndWhere) {
  const auto complaint = [&](double rate_hz, double duration_s, double asked_s) {
    write(makeDive("station", 3, kPanel_odom), rate_hz, duration_s);
    try {
      GivenPath(file_, asked_s);
    } catch (const Error& error) {
      return error.where + ": " + error.why;
    }
    return std::string();
  };
  EXPECT_EQ(complaint(20, 10, 10), "");
  EXPECT_EQ(complaint(20, 10, 11), ": must reach from 0 to 11 s");
  EXPECT_EQ(complaint(5, 10, 10), "0.2 s: is more than 0.1 s after the pose before");
}

TEST(SealedInertialUnit, StrapdownIntegrationReturnsThePath) {
  const Vehicle vehicle;
  const SealedCase sealed = exampleCase();
  const Dive dive = makeDive("rich", 3, kPanel_odom);
  InertialUnit ins(vehicle, sealed, dive);
  constexpr double kInterval_s = 0.01;
  const Pose T_robot_ins = vehicle.ins.pose.pose();
  const Motion start = dive.at(-kInterval_s / 2);
  Pose T_odom_ins = start.T_odom_robot * T_robot_ins;
  Vector3d velocity_odom = start.T_odom_robot.rotation * start.velocityOf(T_robot_ins.position);
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    const InsSample sample = ins.read(i * kInterval_s);
    const Vector3d turn = *sample.angular_velocity_ins * kInterval_s;
    const Matrix3d R_odom_ins_middle = T_odom_ins.rotation * expSO3<double>(turn / 2);
    const Vector3d acceleration_odom =
        R_odom_ins_middle * *sample.specific_force_ins + Vector3d(0, 0, -9.80665);
    T_odom_ins.position += velocity_odom * kInterval_s + acceleration_odom * kInterval_s * kInterval_s / 2;
    velocity_odom += acceleration_odom * kInterval_s;
    T_odom_ins.rotation *= expSO3<double>(turn);
  }
  const Pose expected = dive.poseAt((kSamples - 0.5) * kInterval_s) * T_robot_ins;
  EXPECT_LT((T_odom_ins.position - expected.position).norm(), 0.002);
  EXPECT_LT(angleBetween(T_odom_ins.rotation, expected.rotation), 1e-6);
}

TEST(SealedSound, Mackenzies_own_check_value) {
  EXPECT_NEAR(soundSpeed_m_s(25, 35, 1000), 1550.744, 1e-3);  // given in his paper
}

TEST(SealedSound, TravelTimeInEvenWaterIsDistanceBySpeed) {
  const SoundProfile sound = SoundProfile::through(1500, 4.4, 0);
  EXPECT_NEAR(sound.speedAt(4.4), 1500, 1e-6);
  EXPECT_NEAR(sound.travelTime_s(4, 6, radians(30)), 2 / std::cos(radians(30)) / 1500, 1e-7);
}

/// The largest difference of what the log reads from its true velocity, over a dive.
double largestError_m_s(const std::string& effects, double scale) {
  const Vehicle vehicle;
  const SealedCase sealed = exampleCase(effects);
  const Dive dive = makeDive("rich", 3, kPanel_odom);
  DopplerLog log(vehicle, sealed, dive, kFloor_m);
  const Pose T_robot_dvl = vehicle.dvl.pose.pose();
  double largest_m_s = 0;
  for (double t_s = 0; t_s < 60; t_s += 0.2) {
    const Vector3d expected =
        T_robot_dvl.rotation.transpose() * dive.at(t_s).velocityOf(T_robot_dvl.position);
    largest_m_s = std::max(largest_m_s, (*log.read(t_s).velocity_dvl - scale * expected).norm());
  }
  return largest_m_s;
}

TEST(SealedDopplerLog, ReadsTheTrueVelocity) {
  EXPECT_LT(largestError_m_s("[]", 1), 2e-4);  // beams' echoes come back 0.5 ms apart
}

TEST(SealedDopplerLog, SoundSpeedIsAScale) {
  EXPECT_LT(largestError_m_s(R"([{"id": "dvl-scale", "parameters": {"scale_error": 0.02}}])", 1.02), 2e-4);
  EXPECT_LT(largestError_m_s(R"([{"id": "dvl-scale", "parameters": {"scale_error": -0.06}}])", 0.94), 2e-4);
}

TEST(SealedDopplerLog, AnEffectActsWhileItIsActive) {
  const Vehicle vehicle;
  const SealedCase sealed = exampleCase(
      R"([{"id": "water-current", "parameters": {"current_m_s": [0.1, -0.2, 0]}, "active_s": [10, 20]}])");
  const Dive dive = makeDive("rich", 3, kPanel_odom);
  DopplerLog log(vehicle, sealed, dive, kFloor_m);
  const Pose T_robot_dvl = vehicle.dvl.pose.pose();
  for (const double t_s : {5.0, 15.0, 25.0}) {
    const Motion motion = dive.at(t_s);
    const Vector3d truth = motion.velocityOf(T_robot_dvl.position);
    const Vector3d current = t_s == 15.0 ? Vector3d(0.1, -0.2, 0) : Vector3d::Zero();
    const Vector3d expected =
        T_robot_dvl.rotation.transpose() * (truth - motion.T_odom_robot.rotation.transpose() * current);
    EXPECT_LT((*log.read(t_s).velocity_dvl - expected).norm(), 2e-4) << t_s;
  }
}

TEST(SealedPressureSensor, IsHydrostatic) {
  const Vehicle vehicle;
  const SealedCase sealed =
      exampleCase(R"([{"id": "pressure-density", "parameters": {"density_error_kg_m3": -27}}])");
  const Dive dive = makeDive("station", 3, kPanel_odom);
  PressureSensor sensor(vehicle, sealed, dive);
  const double depth_m = -(dive.poseAt(1) * Vector3d(-0.1, 0.1, 0.1)).z();
  EXPECT_NEAR(sensor.read(1).pressure_pa, 101325 + 998 * 9.80665 * depth_m, 1e-6);
}

}  // namespace
}  // namespace fathom::sealed
