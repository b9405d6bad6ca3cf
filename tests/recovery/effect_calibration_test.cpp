// Each navigation effect, simulated and then given to the filter as its calibration: it must follow the truth
// as if the effect were not there.
#include <gtest/gtest.h>

#include "effects/catalogue.h"
#include "localization/evaluation.h"
#include "localization/localizer.h"
#include "sensors/channel_model.h"
#include "simulation/navigation_simulator.h"
#include "simulation/read_trajectory.h"
#include "support/shipped.h"

namespace fathom {
namespace {

struct Errors {
  double position_m = 0, angle_rad = 0;  ///< largest

  double size() const { return position_m + angle_rad; }
};

class EffectCalibration : public testing::Test {
 protected:
  EffectCalibration() : trajectory_(readTrajectory(test::kSource / "config/dive_trajectory.yaml")) {
    simulation_.vehicle = readVehicle(test::kRov);
    simulation_.vehicle.ins->rate_hz = 50;
    simulation_.vehicle.camera.reset();
    simulation_.vehicle.compass.emplace();
    simulation_.duration_s = 30.0;
    simulation_.begin_s = 1.0;  // a latency reaches back
    simulation_.noise = false;
  }

  bool with_compass = false;  ///< fused
  /// Of the filter that starts at the truth and knows `calibration`.
  Errors errors(const EffectParameters<double>& effects, const EffectParameters<double>& calibration) {
    simulation_.effects = effects;
    std::vector<Sample> samples;
    std::vector<StampedPose> truth;
    simulateNavigation(simulation_, trajectory_, [&](const Sample& sample) {
      if (sample.label == labels::kTruth)
        truth.push_back({sample.time, std::get<PoseSample>(sample.reading).T_odom_robot.mean});
      else
        samples.push_back(sample);
    });
    LocalizationSetup setup;
    setup.vehicle = simulation_.vehicle;
    setup.calibration = calibration;
    setup.options.fuse.push_back(kChannel<Depth>);
    if (with_compass) setup.options.fuse.push_back(kChannel<Compass>);
    setup.options.gate.kind = Gate::Kind::none;
    setup.options.adapts_noise =
        false;  // what the calibration makes up for, not what the filter finds by itself
    setup.time_zero = simulation_.start;
    setup.start = StartPose{.T_odom_robot = truth.front().T_odom_robot, .position_sigma_m = 0.01};
    Errors largest;
    LocalizationSink sink;
    sink.estimate = [&](const Estimate& e) {
      const auto there = poseAt(truth, e.time);
      if (!there || e.t_s < 5) return;  // the first seconds are for the velocity
      const auto& motion = e.state.motion;
      largest.position_m = std::max(largest.position_m, (motion.position_odom - there->position).norm());
      largest.angle_rad = std::max(largest.angle_rad, angleBetween(motion.R_odom_robot, there->rotation));
    };
    std::size_t k = 0;
    localize(
        setup,
        [&]() -> std::optional<Sample> {
          return k == samples.size() ? std::nullopt : std::optional(samples[k++]);
        },
        sink);
    return largest;
  }

 private:
  SimulationOptions simulation_;
  Trajectory trajectory_;
};

TEST_F(EffectCalibration, MakesUpForEveryNavigationEffect) {
  for (const EffectInfo& effect : allEffects()) {
    if (effect.text.channel != EffectChannel::navigation) continue;
    with_compass = modelOf(kChannel<Compass>).effects[effect.index];
    const Errors nominal = errors({}, {});
    EffectParameters<double> effects;
    effects.on.set(effect.index);
    // In half a minute a clock hardly drifts: as far as in ten minutes.
    const double priors = effect.has(ParameterKind::sensor) ? 60 : 3;
    std::size_t i = effect.first_scalar;
    for (const Parameter& p : effect.parameters)
      for (int k = 0; k < p.size; ++k) effects.values[i++] = priors * p.prior_sigma;
    const Errors with = errors(effects, effects), without = errors(effects, {});
    EXPECT_LT(with.size(), nominal.size() + 0.1 * (without.size() - nominal.size())) << effect.id;
    EXPECT_GT(without.size(), 1.2 * nominal.size()) << effect.id;
  }
}

/// A current that comes and goes with its interval.
TEST_F(EffectCalibration, MakesUpForACurrentWhileItIsThere) {
  EffectParameters<double> current;
  current.add<WaterCurrent>({0.2, -0.1, 0});
  auto always = current;
  current.active_s[kEffectIndex<WaterCurrent>] = {10, 20};
  const Errors nominal = errors({}, {}), with = errors(current, current), wrong = errors(current, always);
  EXPECT_LT(with.position_m, nominal.position_m + 0.05);
  EXPECT_GT(wrong.position_m, 1.0);
}

}  // namespace
}  // namespace fathom
