#include <gtest/gtest.h>

#include "simulation/read_trajectory.h"
#include "support/motions.h"
#include "support/simulated.h"

namespace fathom {
namespace {

/// Integrates gyro and accelerometer alone from the true start; returns the worst error against TRUTH over
/// the run: metres, then radians. Shares nothing with the forward model: trapezoid and AngleAxis.
Vector3d strapdownError(const Trajectory& trajectory, double begin_s, double duration_s, double rate_hz) {
  SimulationOptions options;
  options.vehicle = test::slantedVehicle();
  options.vehicle.ins->rate_hz = rate_hz;
  options.noise = false;
  options.begin_s = begin_s;
  options.duration_s = duration_s;
  options.truth_rate_hz = 1;
  const auto samples = test::simulated(options, trajectory);
  const auto& ins = samples.at(labels::kIns);
  const Pose& T_robot_ins = options.vehicle.ins->T_robot_ins;

  const double h = 1e-4;  // the start's velocity: difference of two poses, good to 1e-8 m/s
  const auto insPose = [&](double t) {
    const auto state = trajectory.at(begin_s + t);
    return Pose{state.R_odom_robot, state.position_odom} * T_robot_ins;
  };
  Pose T = insPose(0);
  Vector3d velocity = (insPose(h).position - insPose(-h).position) / (2 * h);

  double worst_m = 0, worst_rad = 0;
  std::size_t truth = 0;
  for (std::size_t i = 0; i < ins.size(); ++i) {
    const auto& now = std::get<InsSample>(ins[i].reading);
    if (truth < samples.at(labels::kTruth).size() && samples.at(labels::kTruth)[truth].time == ins[i].time) {
      const auto& pose = std::get<PoseSample>(samples.at(labels::kTruth)[truth++].reading);
      const Pose T_odom_robot = T * T_robot_ins.inverse();
      const Pose expected = pose.T_odom_robot.mean;
      worst_m = std::max(worst_m, (T_odom_robot.position - expected.position).norm());
      worst_rad = std::max(worst_rad, angleBetween(T_odom_robot.rotation, expected.rotation));
    }
    if (i + 1 == ins.size()) break;
    const auto& next = std::get<InsSample>(ins[i + 1].reading);
    const double dt = secondsBetween(ins[i].time, ins[i + 1].time);
    const Vector3d turn = 0.5 * dt * (*now.angular_velocity_ins + *next.angular_velocity_ins);
    const Matrix3d R_next = T.rotation * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    const Vector3d force_odom =
        0.5 * (T.rotation * *now.specific_force_ins + R_next * *next.specific_force_ins);
    const Vector3d acceleration = force_odom + Vector3d(0, 0, -9.80665);
    T.position += dt * velocity + 0.5 * dt * dt * acceleration;
    velocity += dt * acceleration;
    T.rotation = R_next;
  }
  EXPECT_GE(truth, static_cast<std::size_t>(duration_s));
  testing::Test::RecordProperty("worst_m", std::to_string(worst_m));
  testing::Test::RecordProperty("worst_rad", std::to_string(worst_rad * 1e6) + "e-6");
  return {worst_m, worst_rad, 0};
}

// The trapezoid is wrong by dt²/12 times the change of the integrand's slope: for tilt, at 1 kHz and 0.1
// rad/s² within one period, 1e-8 rad, which gravity turns into 1e-4 m in 60 s. Asked for with a margin of
// about seven.
TEST(Strapdown, NoiselessInertialReadingsReproduceThePose) {
  const Vector3d error = strapdownError(test::sineTrajectory(70), 3.0, 60.0, 1000);
  EXPECT_LT(error[0], 1e-3);
  EXPECT_LT(error[1], 3e-7);
}

// Ten times finer steps: a hundred times better, so what is left is the test's integration, not the sensors.
TEST(Strapdown, FinerStepsConverge) {
  const Trajectory trajectory = test::sineTrajectory(40);
  const Vector3d coarse = strapdownError(trajectory, 1.0, 30.0, 200);
  const Vector3d fine = strapdownError(trajectory, 1.0, 30.0, 1000);
  EXPECT_GT(coarse[0] / fine[0], 15);
  EXPECT_GT(coarse[1] / fine[1], 15);
}

TEST(Strapdown, HoldsOnTheShippedDive) {
  const Trajectory dive =
      readTrajectory(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/dive_trajectory.yaml");
  const Vector3d error = strapdownError(dive, 150.0, 60.0, 1000);
  EXPECT_LT(error[0], 1e-3);
  EXPECT_LT(error[1], 3e-7);
}

}  // namespace
}  // namespace fathom
