#include "simulation/navigation_simulator.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "support/motions.h"
#include "support/simulated.h"

namespace fathom {
namespace {

using test::kSeaFloor_m;
using test::largestDifference;
using test::noiseless;
using test::reading;
using test::SamplesByLabel;
using test::simulated;
using test::sineTrajectory;

Trajectory standing(const Pose& T_odom_robot, double duration_s) {
  return {{0, duration_s / 3, duration_s * 2 / 3, duration_s}, std::vector<Pose>(4, T_odom_robot)};
}

TEST(NavigationSimulator, StampsAreAnExactGridInTimeOrder) {
  SimulationOptions options = noiseless();
  options.duration_s = 20.0;
  options.vehicle.ins->rate_hz = 30;  // 1/30 s is no whole number of ticks
  std::vector<Sample> all;
  simulateNavigation(options, sineTrajectory(30), [&](const Sample& s) { all.push_back(s); });
  std::map<std::string, int> count;
  const std::map<std::string, double> rate{{"INS", 30},  {"DVL", 5},  {"DVL_BEAMS", 5},
                                           {"DEPTH", 5}, {"USBL", 1}, {"TRUTH", 10}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_LE(all[i > 0 ? i - 1 : 0].time, all[i].time);
    const double exact_s = count[all[i].label]++ / rate.at(all[i].label);
    EXPECT_NEAR(secondsBetween(options.start, all[i].time), exact_s, 0.51e-7);
  }
  for (const auto& [label, hz] : rate) EXPECT_EQ(count[label], static_cast<int>(20 * hz) + 1) << label;
}

// At rest every reading is school physics.
TEST(NavigationSimulator, ReadingsAtRest) {
  const Pose T_odom_robot{rotationFromYawPitchRoll(0.7, 0, 0), {1, 2, -3.5}};
  SimulationOptions options = noiseless();
  options.vehicle.ins->T_robot_ins = {};
  options.vehicle.dvl->T_robot_dvl = {Matrix3d::Identity(), {0.3, 0, -0.1}};
  const auto samples = simulated(options, standing(T_odom_robot, 2));
  const auto& ins = reading<InsSample>(samples, labels::kIns, 50);
  EXPECT_LT(ins.angular_velocity_ins->norm(), 1e-12);
  EXPECT_LT((*ins.specific_force_ins - Vector3d(0, 0, 9.80665)).norm(), 1e-12);
  EXPECT_LT(angleBetween(*ins.R_odom_ins, T_odom_robot.rotation), 1e-12);
  EXPECT_LT(reading<DvlSample>(samples, labels::kDvl, 5).velocity_dvl->norm(), 1e-12);
  for (const DvlBeam& beam : reading<DvlBeamsSample>(samples, labels::kDvlBeams, 5).beams)
    EXPECT_NEAR(beam.range_m.value(), (-3.5 - 0.1 - kSeaFloor_m) / std::cos(radians(30)), 1e-12);
  EXPECT_NEAR(reading<DepthSample>(samples, labels::kDepth, 5).pressure_pa, 101325 + 1025 * 9.80665 * 3.4,
              1e-6);
  EXPECT_EQ(reading<PoseSample>(samples, labels::kUsbl, 1).T_robot_sensor.position, Vector3d(0.1, 0, 0.4));
  const auto& usbl = reading<PoseSample>(samples, labels::kUsbl, 1).T_odom_robot;
  EXPECT_LT((usbl.mean.position - T_odom_robot * Vector3d(0.1, 0, 0.4)).norm(), 1e-12);
  EXPECT_EQ(usbl.covariance(0, 0), 0.25);
  EXPECT_GE(usbl.covariance(5, 5), 1e6);
}

// Finite differences of the sensor's own path, as seen through Pose products alone.
TEST(NavigationSimulator, ReadingsInMotion) {
  const Trajectory trajectory = sineTrajectory(30);
  const SimulationOptions options = noiseless();
  const auto samples = simulated(options, trajectory);
  const auto poseOf = [&](const Pose& T_robot_sensor, double t) {
    const auto state = trajectory.at(t);
    return Pose{state.R_odom_robot, state.position_odom} * T_robot_sensor;
  };
  constexpr double h = 1e-4;  // s; velocity: h²/6 p''' = 1e-9 m/s. Force: rounding 4e-16/h² and a knot's jump
  for (std::size_t k = 1; k < 29; ++k) {
    const double t = static_cast<double>(k) + 0.4;
    const auto& dvl = reading<DvlSample>(samples, labels::kDvl, 5 * k + 2);
    const auto at = [&](double dt) { return poseOf(options.vehicle.dvl->T_robot_dvl, t + dt); };
    const Vector3d velocity_odom = (at(h).position - at(-h).position) / (2 * h);
    EXPECT_LT((at(0).rotation.transpose() * velocity_odom - *dvl.velocity_dvl).norm(), 1e-7);

    const auto& ins = reading<InsSample>(samples, labels::kIns, 100 * k + 43);  // between knots
    const auto ins_at = [&](double dt) { return poseOf(options.vehicle.ins->T_robot_ins, t + 0.03 + dt); };
    const Vector3d acceleration_odom =
        (ins_at(h).position - 2 * ins_at(0).position + ins_at(-h).position) / (h * h);
    const Vector3d force = ins_at(0).rotation.transpose() * (acceleration_odom + Vector3d(0, 0, 9.80665));
    EXPECT_LT((force - *ins.specific_force_ins).norm(), 1e-5);
    const Vector3d rate = logSO3<double>(ins_at(-h).rotation.transpose() * ins_at(h).rotation) / (2 * h);
    EXPECT_LT((rate - *ins.angular_velocity_ins).norm(), 1e-7);
    EXPECT_LT(angleBetween(*ins.R_odom_ins, ins_at(0).rotation), 1e-12);

    const auto& beams = reading<DvlBeamsSample>(samples, labels::kDvlBeams, 5 * k + 2).beams;
    for (const DvlBeam& beam : beams) {
      const Pose T_odom_beam = poseOf(beam.T_robot_beam, t);
      EXPECT_NEAR((T_odom_beam * Vector3d(*beam.range_m, 0, 0)).z(), kSeaFloor_m, 1e-9);
    }
    EXPECT_NEAR(reading<DepthSample>(samples, labels::kDepth, 5 * k + 2).pressure_pa,
                101325 - 1025 * 9.80665 * poseOf(options.vehicle.depth->T_robot_depth, t).position.z(), 1e-6);
    const auto truth = reading<PoseSample>(samples, labels::kTruth, 10 * k + 4).T_odom_robot.mean;
    EXPECT_LT((truth.position - test::sinePose(t).position).norm(), 1e-9);  // a knot
  }
}

TEST(NavigationSimulator, NoBottomLockOutOfReach) {
  SimulationOptions options = noiseless();
  options.beam_max_range_m = 2.0;  // the floor is 3 m away
  auto samples = simulated(options, standing({Matrix3d::Identity(), {0, 0, -4}}, 2));
  EXPECT_FALSE(reading<DvlSample>(samples, labels::kDvl, 3).velocity_dvl);
  EXPECT_FALSE(reading<DvlBeamsSample>(samples, labels::kDvlBeams, 3).beams[0].range_m);
  EXPECT_EQ(samples.at(labels::kDvl).size(), 11U);

  options.beam_max_range_m = 50;  // upside down: all beams look up
  samples = simulated(options, standing({rotationFromYawPitchRoll(0, 0, radians(180)), {0, 0, -4}}, 2));
  EXPECT_FALSE(reading<DvlSample>(samples, labels::kDvl, 3).velocity_dvl);
  for (const DvlBeam& beam : reading<DvlBeamsSample>(samples, labels::kDvlBeams, 3).beams)
    EXPECT_FALSE(beam.range_m);

  // Rolled by 65 degrees, with the DVL square on: the port beam at 30 degrees looks up, the others do not.
  options.vehicle.dvl->T_robot_dvl = {};
  samples = simulated(options, standing({rotationFromYawPitchRoll(0, 0, radians(65)), {0, 0, -4}}, 2));
  EXPECT_TRUE(reading<DvlSample>(samples, labels::kDvl, 3).velocity_dvl);
  const auto& beams = reading<DvlBeamsSample>(samples, labels::kDvlBeams, 3).beams;
  EXPECT_EQ(std::count_if(beams.begin(), beams.end(), [](const DvlBeam& b) { return b.range_m.has_value(); }),
            3);
}

// ---- noise
// -------------------------------------------------------------------------------------------------

/// Mean, sigma and lag-1 correlation of a sequence.
struct Statistics {
  double mean = 0, sigma = 0, correlation = 0;
  explicit Statistics(const std::vector<double>& x) {
    const auto n = static_cast<double>(x.size());
    for (const double v : x) mean += v / n;
    double lagged = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sigma += std::pow(x[i] - mean, 2) / n;
      if (i > 0) lagged += (x[i] - mean) * (x[i - 1] - mean) / n;
    }
    correlation = lagged / sigma;
    sigma = std::sqrt(sigma);
  }
};

/// White with this sigma: mean, sigma and correlation within 4.5 of their own standard errors (two in a
/// hundred thousand honest sequences fail; seeds are fixed).
void expectWhite(const std::vector<double>& x, double sigma, const std::string& what) {
  const Statistics s(x);
  const auto n = static_cast<double>(x.size());
  EXPECT_NEAR(s.mean, 0, 4.5 * sigma / std::sqrt(n)) << what;
  EXPECT_NEAR(s.sigma, sigma, 4.5 * sigma / std::sqrt(2 * n)) << what;
  EXPECT_NEAR(s.correlation, 0, 4.5 / std::sqrt(n)) << what;
}

/// Noisy minus noiseless readings: channel[j] is the error of the j-th number of every reading.
std::vector<std::vector<double>> errorsOf(const std::vector<Sample>& noisy,
                                          const std::vector<Sample>& clean) {
  std::vector<std::vector<double>> errors;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const auto a = test::numbersOf(noisy[i]), b = test::numbersOf(clean[i]);
    errors.resize(a.size());
    for (std::size_t j = 0; j < a.size(); ++j) errors[j].push_back(a[j] - b[j]);
  }
  return errors;
}

TEST(NavigationSimulator, WhiteNoiseIsThatOfTheDataSheet) {
  SimulationOptions options = noiseless();
  Vehicle& vehicle = options.vehicle;
  vehicle.ins->gyro_bias_sigma_rad_s = vehicle.ins->accelerometer_bias_sigma_m_s2 = 0;
  vehicle.depth->pressure_offset_sigma_pa = 0;
  vehicle.usbl->rate_hz = 5;
  const Trajectory trajectory = sineTrajectory(300, 0.25);
  const auto clean = simulated(options, trajectory);
  options.noise = true;
  const auto noisy = simulated(options, trajectory);

  const auto ins = errorsOf(noisy.at(labels::kIns), clean.at(labels::kIns));
  for (std::size_t j = 0; j < 3; ++j) expectWhite(ins[j], vehicle.ins->gyro_sigma_rad_s, "gyro");
  for (std::size_t j = 3; j < 6; ++j) expectWhite(ins[j], vehicle.ins->accelerometer_sigma_m_s2, "force");
  const auto dvl = errorsOf(noisy.at(labels::kDvl), clean.at(labels::kDvl));
  expectWhite(dvl[0], vehicle.dvl->velocity_sigma_xy_m_s, "dvl x");
  expectWhite(dvl[1], vehicle.dvl->velocity_sigma_xy_m_s, "dvl y");
  expectWhite(dvl[2], vehicle.dvl->velocity_sigma_z_m_s, "dvl z");
  const auto beams = errorsOf(noisy.at(labels::kDvlBeams), clean.at(labels::kDvlBeams));
  ASSERT_EQ(beams.size(), 4U);
  for (const auto& beam : beams) expectWhite(beam, vehicle.dvl->range_sigma_m, "range");
  const auto depth = errorsOf(noisy.at(labels::kDepth), clean.at(labels::kDepth));
  expectWhite(depth[0], vehicle.depth->pressure_sigma_pa, "pressure");
  const auto usbl = errorsOf(noisy.at(labels::kUsbl), clean.at(labels::kUsbl));
  for (std::size_t j = 0; j < 3; ++j) expectWhite(usbl[j], vehicle.usbl->position_sigma_m, "usbl");
  EXPECT_EQ(largestDifference(noisy.at(labels::kTruth), clean.at(labels::kTruth)), 0);

  std::vector<std::vector<double>> attitude(3);
  for (std::size_t i = 0; i < noisy.at(labels::kIns).size(); ++i) {
    const Vector3d error = logSO3<double>(reading<InsSample>(clean, labels::kIns, i).R_odom_ins->transpose() *
                                          *reading<InsSample>(noisy, labels::kIns, i).R_odom_ins);
    for (std::size_t j = 0; j < 3; ++j) attitude[j].push_back(error[static_cast<Eigen::Index>(j)]);
  }
  for (const auto& axis : attitude) expectWhite(axis, vehicle.ins->attitude_sigma->heading_rad, "attitude");
}

TEST(NavigationSimulator, BiasIsTheGaussMarkovProcessOfTheDataSheet) {
  SimulationOptions options = noiseless();
  Vehicle& vehicle = options.vehicle;
  vehicle.ins->gyro_sigma_rad_s = vehicle.ins->accelerometer_sigma_m_s2 = 0;
  vehicle.ins->bias_time_constant_s = 2.0;
  vehicle.ins->rate_hz = 10;
  const Trajectory trajectory = sineTrajectory(4000, 2.0);
  const auto clean = simulated(options, trajectory);
  options.noise = true;
  const auto errors = errorsOf(simulated(options, trajectory).at(labels::kIns), clean.at(labels::kIns));
  // 4000 s are 2000 time constants. Correlation over 0.1 s: exp(-0.05), standard error
  // sqrt((1 - r²)/n) = 0.0015. Variance: n_eff = n (1 - r²)/(1 + r²) = 2000 samples, sigma to 1.6 %.
  const double decay = std::exp(-0.1 / 2.0);
  for (std::size_t j = 0; j < 6; ++j) {
    const double sigma =
        j < 3 ? vehicle.ins->gyro_bias_sigma_rad_s : vehicle.ins->accelerometer_bias_sigma_m_s2;
    const Statistics s(errors[j]);
    EXPECT_NEAR(s.sigma, sigma, 4.5 * 0.0158 * sigma);
    EXPECT_NEAR(s.correlation, decay, 4.5 * 0.0015);
    std::vector<double> innovation;  // what is new each step is white, of variance (1 - r²) sigma²
    for (std::size_t i = 1; i < errors[j].size(); ++i)
      innovation.push_back(errors[j][i] - decay * errors[j][i - 1]);
    expectWhite(innovation, sigma * std::sqrt(1 - decay * decay), "innovation");
  }
}

TEST(NavigationSimulator, BiasAndPressureOffsetBeginStationary) {
  SimulationOptions options = noiseless();
  Vehicle& vehicle = options.vehicle;
  vehicle.ins->gyro_sigma_rad_s = vehicle.ins->accelerometer_sigma_m_s2 = 0;
  vehicle.depth->pressure_sigma_pa = 0;
  options.duration_s = 0.3;
  const Trajectory trajectory = sineTrajectory(10);
  const auto clean = simulated(options, trajectory);
  options.noise = true;
  std::vector<double> gyro, force, offset;
  for (options.seed = 1; options.seed <= 1000; ++options.seed) {
    const auto noisy = simulated(options, trajectory);
    const auto ins = errorsOf(noisy.at(labels::kIns), clean.at(labels::kIns));
    const auto depth = errorsOf(noisy.at(labels::kDepth), clean.at(labels::kDepth));
    gyro.push_back(ins[0][0]);
    force.push_back(ins[4][0]);
    offset.push_back(depth[0][0]);
    ASSERT_NEAR(depth[0][1], depth[0][0], 1e-9);  // constant over a run
  }
  expectWhite(gyro, vehicle.ins->gyro_bias_sigma_rad_s, "gyro bias");
  expectWhite(force, vehicle.ins->accelerometer_bias_sigma_m_s2, "accelerometer bias");
  expectWhite(offset, vehicle.depth->pressure_offset_sigma_pa, "pressure offset");
}

TEST(NavigationSimulator, SameSeedSameSamplesOtherSeedOthers) {
  SimulationOptions options = noiseless();
  options.noise = true;
  const Trajectory trajectory = sineTrajectory(20);
  const auto once = simulated(options, trajectory), again = simulated(options, trajectory);
  options.seed = 2;
  const auto other = simulated(options, trajectory);
  for (const auto& [label, samples] : once) {
    EXPECT_EQ(largestDifference(samples, again.at(label)), 0) << label;
    EXPECT_EQ(largestDifference(samples, other.at(label)) > 0, label != labels::kTruth) << label;
  }
}

TEST(NavigationSimulator, LeavingOutASensorChangesNoOther) {
  SimulationOptions all = noiseless();
  all.noise = true;
  const Trajectory trajectory = sineTrajectory(20);
  const auto with = simulated(all, trajectory);
  for (const char* label : {labels::kIns, labels::kDvl, labels::kDepth, labels::kUsbl}) {
    SimulationOptions less = all;
    if (label == labels::kIns) less.vehicle.ins.reset();
    if (label == labels::kDvl) less.vehicle.dvl.reset();
    if (label == labels::kDepth) less.vehicle.depth.reset();
    if (label == labels::kUsbl) less.vehicle.usbl.reset();
    const auto without = simulated(less, trajectory);
    EXPECT_FALSE(without.contains(label));
    for (const auto& [other, samples] : without)
      EXPECT_EQ(largestDifference(samples, with.at(other)), 0) << other;
  }
  SimulationOptions no_attitude = all;
  no_attitude.vehicle.ins->attitude_sigma.reset();
  const auto plain = simulated(no_attitude, trajectory);
  EXPECT_FALSE(reading<InsSample>(plain, labels::kIns, 3).R_odom_ins);
  EXPECT_EQ(*reading<InsSample>(plain, labels::kIns, 3).specific_force_ins,
            *reading<InsSample>(with, labels::kIns, 3).specific_force_ins);
}

TEST(NavigationSimulator, RefusesToLeaveTheTrajectory) {
  const Trajectory trajectory = sineTrajectory(10);
  SimulationOptions options = noiseless();
  const auto run = [&] { simulated(options, trajectory); };
  options.begin_s = -0.1;
  EXPECT_THROW(run(), Error);
  options.begin_s = 10.1;
  EXPECT_THROW(run(), Error);
  options.begin_s = 4;
  options.duration_s = 6.1;
  EXPECT_THROW(run(), Error);
  options.duration_s = 0;
  EXPECT_THROW(run(), Error);
  options.duration_s = 6;
  EXPECT_NO_THROW(run());
}

TEST(NavigationSimulator, BeginsWhereItIsTold) {
  const Trajectory trajectory = sineTrajectory(10);
  SimulationOptions options = noiseless();
  options.begin_s = 4;
  const auto samples = simulated(options, trajectory);
  EXPECT_EQ(samples.at(labels::kIns).front().time, options.start);
  const auto truth = reading<PoseSample>(samples, labels::kTruth, 0).T_odom_robot.mean;
  EXPECT_LT((truth.position - test::sinePose(4).position).norm(), 1e-9);
  EXPECT_EQ(samples.at(labels::kTruth).size(), 61U);
}

}  // namespace
}  // namespace fathom
