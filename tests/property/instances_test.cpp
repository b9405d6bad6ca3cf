// Several instruments of a kind on one vehicle ("DVL", "DVL.2"): each by its own specification, with noise,
// drift and effects of its own.
#include <gtest/gtest.h>

#include "effects/calibration.h"
#include "estimation/batch_estimate.h"
#include "localization/localizer.h"
#include "support/batch_runs.h"
#include "support/effects_from.h"
#include "support/observed.h"
#include "support/random_effects.h"
#include "support/simulated.h"

namespace fathom {
namespace {

using test::simulated;

const Instance kSecond = *Instance::named("2");

/// A second one of each of the slanted vehicle's instruments, mounted elsewhere, and otherwise specified.
Vehicle twoOfEach() {
  Vehicle vehicle = test::slantedVehicle();
  SensorsOnBoard second = vehicle;
  const Pose elsewhere{rotationFromYawPitchRoll(-0.7, 0.2, 0.4), {0.4, 0.3, -0.2}};
  second.ins->T_robot_ins = elsewhere;
  second.ins->rate_hz = 50;
  second.ins->gyro_sigma_rad_s *= 3;
  second.dvl->T_robot_dvl = elsewhere;
  second.dvl->rate_hz *= 2;
  second.dvl->velocity_sigma_xy_m_s *= 2;
  second.depth->T_robot_depth = elsewhere;
  second.depth->pressure_sigma_pa *= 2;
  second.depth->pressure_offset_sigma_pa *= 3;
  second.usbl->T_robot_usbl = elsewhere;
  vehicle.others[kSecond] = second;
  return vehicle;
}

SimulationOptions twice() {
  SimulationOptions options = test::noiseless();
  options.vehicle = twoOfEach();
  return options;
}

bool isOfSecond(const std::string& label) { return label.ends_with(".2"); }

TEST(Instances, EachReadsWhatItsOwnSpecificationSays) {
  const SimulationOptions options = twice();
  const Trajectory trajectory = test::sineTrajectory(10);
  const auto entries = simulated(options, trajectory);
  std::set<Channel> of_second;
  for (const auto& [label, samples] : entries)
    for (const Sample& sample : samples) {
      const std::string& who = sample.label;
      const double t_s = secondsBetween(options.start, sample.time);
      const Inputs<double> in =
          test::inputs(trajectory.at(t_s), {options.vehicle.gravityOdom(), test::kSeaFloor_m}, {}, t_s);
      forEachObservation(sample, options.vehicle, [&]<class C>(const Observation& seen) {
        EXPECT_EQ(seen.instance == kSecond, isOfSecond(who)) << who;
        if (isOfSecond(who)) of_second.insert(kChannel<C>);
        const auto predicted = modelOf(kChannel<C>).predict(in, options.vehicle, seen);
        EXPECT_LT((predicted - seen.value).norm(), 1e-8 * (1 + seen.value.norm())) << who;
      });
    }
  EXPECT_EQ(of_second.size(), 7U);  // gyro, accelerometer, attitude, DVL, its beams, depth, USBL
  EXPECT_EQ(entries.at("DVL.2").size(), 2 * entries.at("DVL").size() - 1);
}

TEST(Instances, NoiseIsEachOnesOwn) {
  SimulationOptions options = twice();
  options.noise = true;
  const Trajectory trajectory = test::sineTrajectory(10);
  const auto both = simulated(options, trajectory);
  options.vehicle.others.clear();
  const auto alone = simulated(options, trajectory);
  for (const auto& [label, samples] : alone)
    EXPECT_EQ(test::largestDifference(samples, both.at(label)), 0) << label;
  // The same specification, the same motion: other noise.
  options.vehicle.others[kSecond] = options.vehicle;
  const auto twins = simulated(options, trajectory);
  for (const char* label : {"INS", "DVL", "DEPTH", "USBL"})
    EXPECT_GT(test::largestDifference(twins.at(label), twins.at(std::string(label) + ".2")), 0) << label;
}

TEST(Instances, AnEffectOfOneLeavesTheOthersAlone) {
  const Trajectory trajectory = test::sineTrajectory(10);
  SimulationOptions options = twice();
  const auto nominal = simulated(options, trajectory);
  for (const EffectInfo& effect : allEffects()) {
    if (effect.text.channel != EffectChannel::navigation || !effect.is_of_instrument) continue;
    options.effects = {};
    test::switchOn(effect, options.effects);
    const auto on_each = simulated(options, trajectory);
    options.effects.only[effect.index] = kSecond;
    const auto on_second = simulated(options, trajectory);
    for (const auto& [label, samples] : on_second)
      EXPECT_EQ(test::largestDifference(samples, isOfSecond(label) ? on_each.at(label) : nominal.at(label)),
                0)
          << effect.id << " " << label;
  }
}

TEST(Instances, ACalibrationNamesThem) {
  const auto effects = test::effectsFrom(
      "{id: dvl-scale, scale_error: 0.01, instance: 2},"
      "{id: gyro-scale, scale_error: 0.01, instance: first},"
      "{id: camera-latency, latency_s: 0.1}");
  EXPECT_EQ(effects.only[kEffectIndex<DvlScale>], kSecond);
  EXPECT_EQ(effects.only[kEffectIndex<GyroScale>], Instance());
  EXPECT_FALSE(effects.only[kEffectIndex<CameraLatency>].has_value());
  const std::string text = formatCalibration(effects);
  EXPECT_EQ(formatCalibration(parseCalibration(YamlFile::parse(text, "again").root())), text);
  const auto both = test::effectsFrom(
      "{id: dvl-scale, scale_error: 0.01, instance: first},"
      "{id: dvl-scale, scale_error: -0.02, instance: 2, active_s: [3, 5]}");
  EXPECT_EQ(*both.of({}).of<DvlScale>(), 0.01);
  EXPECT_EQ(*both.of(kSecond).of<DvlScale>(), -0.02);
  EXPECT_TRUE(both.at<double>(4, kSecond).has<DvlScale>());
  EXPECT_FALSE(both.at<double>(6, kSecond).has<DvlScale>());
  const std::string both_text = formatCalibration(both);
  EXPECT_EQ(formatCalibration(parseCalibration(YamlFile::parse(both_text, "again").root())), both_text);
  for (const char* wrong :
       {"{id: marker-size, scale_error: 0.01, instance: 2}",
        "{id: water-current, current_m_s: [0, 0, 1], instance: 2}",
        "{id: dvl-scale, scale_error: 0.01}, {id: dvl-scale, scale_error: 0.02, instance: 2}",
        "{id: dvl-scale, scale_error: 0.01, instance: \"two words\"}"})
    EXPECT_THROW(test::effectsFrom(wrong), Error) << wrong;
}

// Each by its own amount: simulated, and taken off again by filter and batch estimate.
TEST(Instances, OneEffectMayBeOnEachByItsOwnAmount) {
  const auto effects =
      parseCalibration(YamlFile::parse("effects: [{id: dvl-scale, scale_error: 0.05, instance: first},"
                                       "{id: dvl-scale, scale_error: -0.08, instance: 2}]",
                                       "test")
                           .root());
  const Trajectory trajectory = test::sineTrajectory(10);
  SimulationOptions options = twice();
  const auto nominal = simulated(options, trajectory);
  options.effects = effects;
  const auto scaled = simulated(options, trajectory);
  for (const auto& [label, factor] : {std::pair("DVL", 1.05), {"DVL.2", 0.92}}) {
    const Vector3d was = *test::reading<DvlSample>(nominal, label, 5).velocity_dvl,
                   is = *test::reading<DvlSample>(scaled, label, 5).velocity_dvl;
    EXPECT_LT((is - factor * was).norm(), 1e-12) << label;
  }
  EXPECT_NO_THROW(requireInstances(effects, options.vehicle, "test"));
  EXPECT_THROW(requireInstances(effects, test::slantedVehicle(), "test"), Error);

  test::BatchRun run(12.0);
  run.noise = false;
  run.vehicle.others[kSecond].dvl = run.vehicle.dvl;
  run.effects = effects;
  const BatchInput input = run.input(effects);
  BatchOptions known;
  known.calibration = effects;
  const BatchEstimate with = estimateBatch(input.data, input.start, known);
  const BatchEstimate without = estimateBatch(input.data, input.start, {});
  EXPECT_LT(with.residuals.at(kChannel<Dvl>).rms, 0.1);
  EXPECT_GT(without.residuals.at(kChannel<Dvl>).rms, 1.0);
}

struct FilterRun {
  LocalizationSummary summary;
  double nees = 0;       ///< mean over the run, by 6
  double sigma_m = 0;    ///< of the position, at the end
  std::size_t dvls = 0;  ///< entries, of whichever
};

FilterRun filterRun(const Vehicle& vehicle) {
  SimulationOptions options;
  options.vehicle = vehicle;
  const Trajectory trajectory = test::sineTrajectory(60);
  LocalizationSetup setup;
  setup.vehicle = vehicle;
  setup.time_zero = options.start;
  setup.options.fuse = {kChannel<Gyro>, kChannel<Accelerometer>, kChannel<Attitude>,
                        kChannel<Dvl>,  kChannel<Depth>,         kChannel<Usbl>};
  std::vector<Sample> samples;
  simulateNavigation(options, trajectory, [&](const Sample& s) { samples.push_back(s); });
  FilterRun run;
  run.dvls = static_cast<std::size_t>(std::count_if(
      samples.begin(), samples.end(), [](const Sample& s) { return baseOf(s.label) == labels::kDvl; }));
  std::size_t next = 0;
  int count = 0;
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& e) {
    if (e.t_s < 10) return;
    const auto truth = trajectory.at(e.t_s);
    Vector6d error;
    error << e.state.motion.position_odom - truth.position_odom,
        logSO3<double>(e.state.motion.R_odom_robot.transpose() * truth.R_odom_robot);
    run.nees += error.dot(e.pose_covariance.llt().solve(error)) / 6;
    run.sigma_m = std::sqrt(e.pose_covariance.topLeftCorner<3, 3>().trace());
    ++count;
  };
  run.summary = localize(
      setup, [&] { return next < samples.size() ? std::optional(samples[next++]) : std::nullopt; }, sink);
  run.nees /= count;
  return run;
}

// Two of each tell more than one, and the filter is right about how much: it was told nothing of them but the
// vehicle file, where the second INS and pressure sensor drift by more than it has states for.
TEST(Instances, AFilterOfTwoOfEachIsConsistent) {
  Vehicle vehicle = twoOfEach();
  vehicle.others[kSecond].ins->gyro_bias_sigma_rad_s *= 20;
  const FilterRun two = filterRun(vehicle);
  vehicle.others.clear();
  const FilterRun one = filterRun(vehicle);
  const auto fusedOf = [](const FilterRun& run) {
    const ChannelSummary& dvl = run.summary.channels.at(kChannel<Dvl>);
    return dvl.fused + dvl.gated;
  };
  EXPECT_EQ(fusedOf(one), one.dvls);
  EXPECT_EQ(fusedOf(two), two.dvls);
  EXPECT_GT(two.dvls, 2 * one.dvls);
  EXPECT_LT(two.sigma_m, 0.9 * one.sigma_m);
  // One run's errors are correlated over the whole of it, so that the mean hardly averages; a wrong mounting,
  // or a bias taken for another's, makes it hundreds.
  EXPECT_LT(one.nees, 3);
  EXPECT_LT(two.nees, 3);
}

// A drift for each, found: of the second INS, that its gyro is off; of the first, that it is not. Without
// noise what is left is the spline's, some 0.1 % of the motion (batch_estimate_test.cpp).
TEST(Instances, ABatchFindsEachOnesDrift) {
  test::BatchRun run(20.0);
  run.noise = false;
  run.vehicle.others[kSecond].ins = run.vehicle.ins;
  run.vehicle.others[kSecond].ins->gyro_bias_sigma_rad_s = 2e-3;
  run.effects.add<GyroBias>({2e-3, -1e-3, 1.5e-3});
  run.effects.only[kEffectIndex<GyroBias>] = kSecond;
  const BatchInput input = run.input();
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  const auto first = estimate.state.driftOf(kChannel<Gyro>, {}),
             second = estimate.state.driftOf(kChannel<Gyro>, kSecond);
  ASSERT_TRUE(first && second);
  const Vector3d hidden(2e-3, -1e-3, 1.5e-3);
  for (std::size_t k = 0; k < estimate.state.drifts[*second].knots.size(); ++k) {
    EXPECT_LT((estimate.state.drifts[*second].knots[k] - hidden).norm(), 0.05 * hidden.norm()) << k;
    EXPECT_LT(estimate.state.drifts[*first].knots[k].norm(), 0.05 * hidden.norm()) << k;
  }
}

}  // namespace
}  // namespace fathom
