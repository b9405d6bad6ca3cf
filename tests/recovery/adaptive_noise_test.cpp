// A filter whose files state the wrong noise is consistent all the same, where it may adapt.
#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "localization/localizer.h"
#include "simulation/navigation_simulator.h"
#include "support/motions.h"
#include "support/sanitized.h"
#include "support/small_vehicle.h"

namespace fathom {
namespace {

/// What a filter by the stated vehicle makes of a dive by another vehicle; from 70 s on.
struct Consistency {
  std::map<std::string, double> nis;            ///< over degrees of freedom
  double attitude_nees = 0, velocity_nees = 0;  ///< over degrees of freedom
};

class Dives {
 public:
  explicit Dives(const Vehicle& true_vehicle) : true_(true_vehicle) {}

  /// Mean of some dives.
  Consistency run(bool adapts) const {
    Consistency mean;
    constexpr int kDives = 5;
    for (std::uint64_t seed = 1; seed <= kDives; ++seed) {
      const Consistency one = run(adapts, seed);
      for (const auto& [channel, nis] : one.nis) mean.nis[channel] += nis / kDives;
      mean.attitude_nees += one.attitude_nees / kDives;
      mean.velocity_nees += one.velocity_nees / kDives;
    }
    return mean;
  }

 private:
  Consistency run(bool adapts, std::uint64_t seed) const {
    constexpr double kDuration_s = 120.0, kSettled_s = 70.0;
    SimulationOptions simulation;
    simulation.vehicle = true_;
    simulation.sea_floor_z_m = -9.0;
    simulation.duration_s = kDuration_s;
    simulation.begin_s = 5.0;
    simulation.seed = seed;
    LocalizationSetup setup;
    setup.vehicle = test::blindVehicle();
    setup.options.adapts_noise = adapts;
    std::vector<Sample> samples;
    simulateNavigation(simulation, path_, [&](const Sample& sample) {
      if (sample.label != labels::kTruth) samples.push_back(sample);
    });
    setup.time_zero = samples.front().time;

    Consistency run;
    std::map<Channel, std::pair<double, double>> sums;
    int count = 0;
    LocalizationSink sink;
    sink.innovation = [&](const Innovation& innovation) {
      if (innovation.t_s < kSettled_s) return;
      sums[innovation.channel].first += innovation.nis;
      sums[innovation.channel].second += innovation.degrees_of_freedom;
    };
    sink.estimate = [&](const Estimate& estimate) {
      if (estimate.t_s < kSettled_s) return;
      const KinematicState<double> truth = path_.at(simulation.begin_s + estimate.t_s);
      const auto& m = estimate.state.motion;
      const Vector3d angle = logSO3<double>(m.R_odom_robot.transpose() * truth.R_odom_robot),
                     velocity = (truth.velocity_robot - m.velocity_robot)
                                    .cwiseQuotient(estimate.velocity_sigma_robot_m_s);
      run.attitude_nees +=
          normalizedSquare(Matrix3d(estimate.pose_covariance.bottomRightCorner<3, 3>()), angle) / 3.0;
      run.velocity_nees += velocity.squaredNorm() / 3.0;
      ++count;
    };
    Localizer localizer(setup, sink);
    for (const Sample& sample : samples) localizer.add(sample);
    localizer.finish();
    for (const auto& [channel, sum] : sums) run.nis[nameOf(channel)] = sum.first / sum.second;
    run.attitude_nees /= count;
    run.velocity_nees /= count;
    return run;
  }

  static Trajectory path() {
    const auto times_s = test::timesBetween(0, 140.0, 0.2);
    std::vector<Pose> poses(times_s.size());
    std::transform(times_s.begin(), times_s.end(), poses.begin(),
                   [](double t) { return test::sinePose(t / 3.0); });
    return {times_s, poses};
  }

  Vehicle true_;
  Trajectory path_ = path();
};

void expectNisInBand(const Consistency& run) {
  for (const auto& [channel, nis] : run.nis) {
    EXPECT_GE(nis, 0.8) << channel;
    EXPECT_LE(nis, 1.2) << channel;
  }
}

void expectConsistent(const Consistency& run) {
  expectNisInBand(run);
  // Five dives, each some fifty independent errors of three numbers.
  EXPECT_GE(run.attitude_nees, 0.7);
  EXPECT_LE(run.attitude_nees, 1.3);
  EXPECT_GE(run.velocity_nees, 0.7);
  EXPECT_LE(run.velocity_nees, 1.3);
}

TEST(AdaptiveNoise, IsConsistentWhereTheFileIsRight) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers look at accesses, not at statistics";
  const Dives dives(test::blindVehicle());
  expectConsistent(dives.run(true));
  EXPECT_LT(dives.run(false).nis.at("gyro"), 0.5) << "by the file's drive, which is of any vehicle";
}

TEST(AdaptiveNoise, IsConsistentWhereSensorsAreTwiceAsNoisy) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers look at accesses, not at statistics";
  Vehicle noisy = test::blindVehicle();
  noisy.ins->gyro_sigma_rad_s *= 2;
  noisy.ins->accelerometer_sigma_m_s2 *= 2;
  noisy.ins->attitude_sigma = radians(1.0);
  noisy.dvl->velocity_sigma_xy_m_s *= 2;
  noisy.dvl->velocity_sigma_z_m_s *= 2;
  const Dives dives(noisy);
  expectConsistent(dives.run(true));
  EXPECT_GT(dives.run(false).nis.at("dvl"), 1.5);
}

// A bias of less than three of the file's sigmas is left as it is, and what there is of the accelerometer's
// shows in the attitude: its NEES is 2, where the file alone gives 100.
TEST(AdaptiveNoise, FindsGyroBiasesThatNobodyToldOf) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers look at accesses, not at statistics";
  Vehicle biased = test::blindVehicle();
  biased.ins->gyro_bias_sigma_rad_s = radians(0.5);
  biased.ins->bias_time_constant_s = 3600;
  const Dives dives(biased);
  const Consistency found = dives.run(true);
  expectNisInBand(found);
  EXPECT_LT(found.attitude_nees, 3.0);
  EXPECT_NEAR(found.velocity_nees, 1.0, 0.3);
  EXPECT_GT(dives.run(false).attitude_nees, 30.0);
}

}  // namespace
}  // namespace fathom
