// The noise that a recording was made with is found again from the filter's innovations alone.
#include "tuning/tune.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "simulation/navigation_simulator.h"
#include "simulation/read_trajectory.h"
#include "support/motions.h"
#include "support/sanitized.h"
#include "support/shipped.h"
#include "support/small_vehicle.h"
#include "tuning/noise_parameters.h"

namespace fathom {
namespace {

/// What a vehicle's instruments do worse, or better, than its file says.
struct Times {
  double gyro = 1, accelerometer = 1, dvl = 1, attitude = 1;
};

/// A robot that moves so gently that from one reading of its INS to the next it changes less than their
/// noise: of one that does not, nothing tells noise from drive.
Trajectory gentle(double duration_s) {
  const auto times_s = test::timesBetween(0, duration_s, 0.2);
  std::vector<Pose> poses(times_s.size());
  std::transform(times_s.begin(), times_s.end(), poses.begin(),
                 [](double t) { return test::sinePose(t / 5.0); });
  return {times_s, poses};
}

TunedRecording dive(const Times& times, std::uint64_t seed, double duration_s) {
  SimulationOptions options;
  options.vehicle = test::blindVehicle();
  InsSheet& ins = *options.vehicle.ins;
  ins.gyro_sigma_rad_s *= times.gyro;
  ins.accelerometer_sigma_m_s2 *= times.accelerometer;
  ins.attitude_sigma = AttitudeSigma(ins.attitude_sigma->heading_rad * times.attitude);
  options.vehicle.dvl->velocity_sigma_xy_m_s *= times.dvl;
  options.vehicle.dvl->velocity_sigma_z_m_s *= times.dvl;
  options.sea_floor_z_m = -9.0;
  options.duration_s = duration_s;
  options.begin_s = 5.0;
  options.seed = seed;
  TunedRecording recording;
  recording.setup.vehicle = test::blindVehicle();
  simulateNavigation(options, gentle(duration_s + 10.0), [&](const Sample& sample) {
    if (sample.label != labels::kTruth) recording.samples.push_back(sample);
  });
  recording.setup.time_zero = recording.samples.front().time;
  return recording;
}

const TunedParameter& named(const Tuning& tuning, const std::string& name) {
  const auto found = std::find_if(tuning.parameters.begin(), tuning.parameters.end(),
                                  [&](const TunedParameter& p) { return p.name == name; });
  if (found == tuning.parameters.end()) throw std::runtime_error("no parameter " + name);
  return *found;
}

Tuning tuned(const TunedRecording& recording, const TuneOptions& how = {}) {
  return tune({recording}, {}, how, [](double) {});
}

TEST(Tune, FindsTheNoiseThatTheInstrumentsHave) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers look at accesses, not at statistics";
  const Times times{0.4, 2.5, 3.0, 0.5};
  const Tuning tuning = tuned(dive(times, 7, 120.0));
  const auto expect = [&](const char* name, double truth) {
    const TunedParameter& p = named(tuning, name);
    EXPECT_TRUE(p.is_told) << name;
    EXPECT_NEAR(p.after / truth, 1.0, 0.1) << name;
    EXPECT_LT(p.low, 1.05 * truth) << name;
    EXPECT_GT(p.high, 0.95 * truth) << name;
  };
  expect("sigma of gyro", times.gyro);
  expect("sigma of accelerometer", times.accelerometer);
  expect("sigma of dvl", times.dvl);
  expect("sigma of attitude", times.attitude);
  for (const auto& [channel, seen] : tuning.scores_after[0].judged.channels) {
    EXPECT_GT(seen.nisMean() / seen.degrees_of_freedom, 0.85) << nameOf(channel);
    EXPECT_LT(seen.nisMean() / seen.degrees_of_freedom, 1.15) << nameOf(channel);
  }
  EXPECT_GT(tuning.judgedGain().value(), 0.1);  // the defaults' drive is too large for this motion
}

TEST(Tune, WhereNothingIsLeftToJudgeByNothingIsGained) { EXPECT_FALSE(Tuning{}.judgedGain()); }

/// A robot that is pushed by fits and starts.
TunedRecording manoeuvres(double duration_s) {
  SimulationOptions options;
  options.vehicle = test::blindVehicle();
  options.duration_s = duration_s;
  TunedRecording recording;
  recording.setup.vehicle = test::blindVehicle();
  const Trajectory trajectory = readTrajectory(test::kConfig / "dive_trajectory.yaml");
  simulateNavigation(options, trajectory, [&](const Sample& sample) {
    if (sample.label != labels::kTruth) recording.samples.push_back(sample);
  });
  recording.setup.time_zero = recording.samples.front().time;
  return recording;
}

// A slope can be taken only where no reading passes a gate here and does not a little farther on.
TEST(Tune, LikelihoodHasNoSteps) {
  const TunedRecording recording = manoeuvres(60.0);
  std::vector<double> values;
  for (int k = 0; k < 12; ++k) {
    LocalizationOptions options;
    options.noise.angular_velocity.setConstant(3e-4);
    options.noise.acceleration.setConstant(3e-3 * std::exp(0.02 * k));
    values.push_back(score(recording, options, {}).fit.log_likelihood);
  }
  for (std::size_t k = 2; k < values.size(); ++k)
    EXPECT_LT(std::abs(values[k] - 2.0 * values[k - 1] + values[k - 2]), 1.0) << k;
}

TEST(Tune, SaysWhereTheDriveIsNotConstant) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers look at accesses, not at statistics";
  EXPECT_FALSE(named(tuned(manoeuvres(60.0)), "sigma of accelerometer").is_constant);
}

// What is met for seconds only cannot be tuned by itself, but must not stay ten times too large.
TEST(Tune, DriveOfAShortRegimeGoesWithTheLongest) {
  Scores scores;
  scores.regimes_s = {{Regime::station_keeping, 5.0}, {Regime::transit, 100.0}, {Regime::turning, 40.0}};
  LocalizationOptions options = writtenOut({}, test::blindVehicle(), scores);
  for (const NoiseParameter& p : noiseParameters(options, test::blindVehicle(), scores))
    p.multiply(options, p.name.ends_with("transit") ? 0.1 : 1.0);
  EXPECT_NEAR(options.noise.acceleration.x() / options.driven.at(Regime::transit).acceleration.x(), 1.0,
              1e-12);
  EXPECT_NEAR(options.noise.acceleration.x() / options.driven.at(Regime::turning).acceleration.x(), 0.01,
              1e-12);
}

// Of the biases the likelihood is so flat that a climb may seem to have ended.
TEST(Tune, EndsAtTheMaximum) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers look at accesses, not at statistics";
  const TunedRecording recording = dive({}, 5, 60.0);
  const Tuning tuning = tuned(recording);
  for (const TunedParameter& p : tuning.parameters) EXPECT_GT(p.high, 1.005 * p.after) << p.name;
  const double found = tuning.scores_after[0].fit.log_likelihood;
  for (const double times : {0.7, 1.4}) {
    LocalizationOptions nearby = tuning.after;
    nearby.biases->gyro_sigma_rad_s *= times;
    nearby.biases->accelerometer_sigma_m_s2 *= times;
    EXPECT_LT(score(recording, nearby, {}).fit.log_likelihood, found + 0.3) << times;
  }
}

TEST(Tune, SaysWhereARecordingIsTooShort) { EXPECT_THROW(tuned(dive({}, 3, 8.0)), Error); }

TEST(Tune, ReadsBackWhatItWrites) {
  const Tuning tuning = tuned(dive({}, 3, 30.0), {.blocks = {.block_s = 5.0}, .most_iterations = 2});
  const auto file = std::filesystem::temp_directory_path() / "fathom-tests" / "tuned.yaml";
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << formatLocalizationOptions(tuning.after);
  EXPECT_EQ(formatLocalizationOptions(readLocalizationOptions(file)),
            formatLocalizationOptions(tuning.after));
}

}  // namespace
}  // namespace fathom
