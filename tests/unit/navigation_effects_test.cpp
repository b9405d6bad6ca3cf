#include <gtest/gtest.h>

#include <algorithm>

#include "simulation/navigation_simulator.h"
#include "support/motions.h"
#include "support/simulated.h"

// Simulated readings with one effect against noiseless nominal ones.
namespace fathom {
namespace {

using test::largestDifference;
using test::noiseless;
using test::reading;
using test::SamplesByLabel;
using test::simulated;
using test::sineTrajectory;

class NavigationEffects : public testing::Test {
 protected:
  const Trajectory trajectory_ = sineTrajectory(30);
  SimulationOptions options_ = noiseless();
  const SamplesByLabel nominal_ = simulated(options_, trajectory_);

  /// Runs with the effect; readings of all sensors but those named must be as before.
  SamplesByLabel run(const std::vector<std::string>& changed) {
    auto samples = simulated(options_, trajectory_);
    for (const auto& [label, list] : nominal_) {
      const bool may_change = std::find(changed.begin(), changed.end(), label) != changed.end();
      EXPECT_EQ(largestDifference(list, samples.at(label)) > 0, may_change) << label;
    }
    return samples;
  }
  static Vector3d velocity(const SamplesByLabel& samples, std::size_t i) {
    return *reading<DvlSample>(samples, labels::kDvl, i).velocity_dvl;
  }
  std::size_t dvlCount() const { return nominal_.at(labels::kDvl).size(); }
};

TEST_F(NavigationEffects, DvlScaleScales) {
  options_.effects.add<DvlScale>({0.012});
  const auto samples = run({"DVL"});
  for (std::size_t i = 0; i < dvlCount(); ++i)
    EXPECT_LT((velocity(samples, i) - 1.012 * velocity(nominal_, i)).norm(), 1e-15);
}

TEST_F(NavigationEffects, DvlMisalignmentTurnsTheSensor) {
  options_.effects.add<DvlMisalignment>({0, 0, 3.0});
  const auto samples = run({"DVL", "DVL_BEAMS"});
  // Turned by +3 degrees about its z, the sensor (and its lever arm stays) sees velocity turned by -3.
  const Eigen::AngleAxisd turn(-radians(3.0), Vector3d::UnitZ());
  for (std::size_t i = 0; i < dvlCount(); ++i)
    EXPECT_LT((velocity(samples, i) - turn * velocity(nominal_, i)).norm(), 1e-14);
}

TEST_F(NavigationEffects, DvlLeverArmAddsOmegaCrossOffset) {
  const Vector3d offset(0.3, -0.2, 0.1);
  options_.effects.add<DvlLeverArm>({offset.x(), offset.y(), offset.z()});
  const auto samples = run({"DVL", "DVL_BEAMS"});
  const Matrix3d R_dvl_robot = options_.vehicle.dvl->T_robot_dvl.rotation.transpose();
  for (std::size_t i = 0; i < dvlCount(); ++i) {
    const auto state = trajectory_.at(0.2 * static_cast<double>(i));
    const Vector3d& w = state.angular_velocity_robot;
    const Vector3d added(w.y() * offset.z() - w.z() * offset.y(), w.z() * offset.x() - w.x() * offset.z(),
                         w.x() * offset.y() - w.y() * offset.x());
    EXPECT_LT((velocity(samples, i) - velocity(nominal_, i) - R_dvl_robot * added).norm(), 1e-14);
  }
}

TEST_F(NavigationEffects, DvlLatencyShiftsByWholeSamples) {
  options_.effects.add<DvlLatency>({0.4});  // two samples: stamped 0.4 s after it was valid
  const auto samples = run({"DVL", "DVL_BEAMS"});
  EXPECT_FALSE(reading<DvlSample>(samples, labels::kDvl, 1).velocity_dvl);  // valid before the trajectory
  for (std::size_t i = 2; i < dvlCount(); ++i)
    EXPECT_LT((velocity(samples, i) - velocity(nominal_, i - 2)).norm(), 1e-13);
}

TEST_F(NavigationEffects, BiasesAndOffsetAreAdded) {
  options_.effects.add<GyroBias>({1e-3, 2e-3, -3e-3});
  options_.effects.add<AccelerometerBias>({0.1, -0.2, 0.3});
  options_.effects.add<PressureOffset>({1500});
  const auto samples = run({"INS", "DEPTH"});
  for (std::size_t i = 0; i < samples.at(labels::kIns).size(); ++i) {
    const auto &with = reading<InsSample>(samples, labels::kIns, i),
               &without = reading<InsSample>(nominal_, labels::kIns, i);
    EXPECT_LT(
        (*with.angular_velocity_ins - *without.angular_velocity_ins - Vector3d(1e-3, 2e-3, -3e-3)).norm(),
        1e-15);
    EXPECT_LT((*with.specific_force_ins - *without.specific_force_ins - Vector3d(0.1, -0.2, 0.3)).norm(),
              1e-14);
  }
  for (std::size_t i = 0; i < samples.at(labels::kDepth).size(); ++i)
    EXPECT_NEAR(reading<DepthSample>(samples, labels::kDepth, i).pressure_pa -
                    reading<DepthSample>(nominal_, labels::kDepth, i).pressure_pa,
                1500, 1e-9);
}

TEST_F(NavigationEffects, CalibratedAndRandomBiasAddUp) {
  options_.noise = true;
  const auto before = simulated(options_, trajectory_);
  options_.effects.add<GyroBias>({0.01, 0, 0});
  const auto after = simulated(options_, trajectory_);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_LT((*reading<InsSample>(after, labels::kIns, i).angular_velocity_ins -
               *reading<InsSample>(before, labels::kIns, i).angular_velocity_ins - Vector3d(0.01, 0, 0))
                  .norm(),
              1e-15);
}

}  // namespace
}  // namespace fathom
