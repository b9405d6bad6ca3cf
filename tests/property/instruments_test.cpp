// Laws that hold for every registered instrument and channel.
#include <gtest/gtest.h>

#include <set>

#include "core/geodesy.h"
#include "localization/localizer.h"
#include "recording/fields.h"
#include "sources/value_changes.h"
#include "support/observed.h"
#include "support/simulated.h"
#include "support/streams.h"

namespace fathom {
namespace {

using test::simulated;

/// Every instrument on board, all mounted aslant; the GNSS antenna above the water.
Vehicle everything() {
  Vehicle vehicle = test::slantedVehicle();
  const Pose aslant = vehicle.ins->T_robot_ins;
  vehicle.compass.emplace().T_robot_compass = aslant;
  vehicle.gnss.emplace().origin = {54.3, 10.1, 35};
  vehicle.gnss->odom_yaw_rad = 0.4;
  vehicle.gnss->T_robot_gnss = {Matrix3d::Identity(), {0.1, -0.2, 20}};
  vehicle.altimeter.emplace().T_robot_altimeter = {rotationFromYawPitchRoll(0.2, radians(80), 0.1),
                                                   {0.3, 0.1, -0.2}};
  return vehicle;
}

test::SamplesByLabel dive(const EffectParameters<double>& effects = {}, bool noise = false) {
  SimulationOptions options = test::noiseless();
  options.vehicle = everything();
  options.effects = effects;
  options.noise = noise;
  return simulated(options, test::sineTrajectory(10));
}

TEST(Instruments, AreToldApart) {
  std::set<std::string> labels, sections;
  std::set<std::uint64_t> streams;
  forEachInstrument([&]<class Instrument>() {
    EXPECT_TRUE(labels.insert(Instrument::label).second) << Instrument::label;
    EXPECT_FALSE(Instrument::section.empty() || Instrument::kind.empty());
    using Simulated = typename Instrument::Simulated;
    for (std::uint64_t k = 0; k < Simulated::kStreams; ++k)
      EXPECT_TRUE(streams.insert(Simulated::kFirstStream + k).second) << Instrument::label;
  });
  std::set<std::string_view> ids;
  for (const Channel channel : kEveryChannel) {
    const ChannelText& text = textOf(channel);
    EXPECT_TRUE(ids.insert(text.id).second) << text.id;
    EXPECT_FALSE(text.label.empty() || text.unit.empty()) << text.id;
    if (text.is_estimated && channel != kChannel<Prior>) {
      EXPECT_FALSE(text.metric.empty()) << text.id;
      EXPECT_GT(text.material, 0) << text.id;
    }
  }
}

// What a noiseless instrument writes is what its channels' models predict, and nothing else.
TEST(Instruments, ReadWhatTheirChannelsPredict) {
  const Vehicle vehicle = everything();
  const Trajectory trajectory = test::sineTrajectory(10);
  std::set<Channel> seen_channels;
  for (const auto& [label, samples] : dive())
    for (const Sample& sample : samples) {
      const double t_s = secondsBetween(SimulationOptions{}.start, sample.time);
      const Inputs<double> in =
          test::inputs(trajectory.at(t_s), {vehicle.gravityOdom(), test::kSeaFloor_m}, {}, t_s);
      forEachObservation(sample, vehicle, [&]<class C>(const Observation& seen) {
        seen_channels.insert(kChannel<C>);
        const auto predicted = modelOf(kChannel<C>).predict(in, vehicle, seen);
        // A place on the Earth is rounded to 1e-9 m there and back; pressure is of 1e5 Pa.
        EXPECT_LT((predicted - seen.value).norm(), 1e-8 * (1 + seen.value.norm())) << C::channel.id;
      });
    }
  EXPECT_EQ(seen_channels.size(), kInstrumentChannelCount);
}

TEST(Instruments, HaveANameForEachOfTheirNumbers) {
  for (const auto& [label, samples] : dive()) {
    std::vector<std::optional<double>> values;
    fieldValues(samples.front().reading, values);
    EXPECT_EQ(fieldNames(samples.front().reading).size(), values.size()) << label;
  }
}

// A model's derivatives, as filter and batch take them, are those of its own differences.
TEST(Instruments, ModelsAskForTheEffectsThatChangeThem) {
  const Vehicle& vehicle = test::fullVehicle();
  for (std::size_t i = 0; i < kInstrumentChannelCount; ++i) {
    const auto channel = static_cast<Channel>(i);
    const Inputs<double> all = exampleInputs();
    for (const EffectInfo& effect : allEffects()) {
      Inputs<double> without = all;
      without.effects.on.reset(effect.index);
      const bool changes = (modelOf(channel).predict(without, vehicle, exampleObservation()) -
                            modelOf(channel).predict(all, vehicle, exampleObservation()))
                               .norm() > 0;
      if (changes) EXPECT_TRUE(modelOf(channel).effects[effect.index]) << nameOf(channel) << " " << effect.id;
    }
  }
}

TEST(Instruments, FaultsAddToTheirOwnValuesOnly) {
  const auto clean = dive();
  for (const AmountText& amount : amountTexts()) {
    Amounts amounts;
    amounts.of(amount.key).setConstant(0.25);
    for (const auto& [label, samples] : clean) {
      Sample changed = samples.front();
      addTo(changed, amounts, [](const Vector3d& a) { return a; });
      const bool concerned =
          std::find(amount.labels.begin(), amount.labels.end(), label) != amount.labels.end();
      if (label == labels::kTruth) continue;
      EXPECT_EQ(test::largestDifference({samples.front()}, {changed}) > 0, concerned)
          << amount.key << " " << label;
    }
  }
}

TEST(Instruments, AFaultMovesAFixByItsMetres) {
  Sample sample = dive().at(Gnss::label).front();
  const Vector3d before = *std::get<GnssSample>(sample.reading).geodetic;
  Amounts amounts;
  amounts.of("fix_m") = {3, -4, 5};
  addTo(sample, amounts, [](const Vector3d& a) { return a; });
  const Vector3d after = *std::get<GnssSample>(sample.reading).geodetic;
  const Vector3d moved = eastNorthUp({after.x(), after.y(), after.z()}, {before.x(), before.y(), before.z()});
  EXPECT_LT((moved - Vector3d(3, -4, 5)).norm(), 1e-6);  // a curved Earth: 50 m² over 6.4e6 m
}

// The filter starts without being told where, and is consistent: mean NIS of each channel within the band
// that 99.99 % of consistent filters keep.
TEST(Instruments, AFilterOfAllOfThemIsConsistent) {
  const Trajectory trajectory = test::sineTrajectory(60);
  SimulationOptions options;
  options.vehicle = everything();
  options.sea_floor_z_m = test::kSeaFloor_m;
  LocalizationSetup setup;
  setup.vehicle = options.vehicle;
  setup.time_zero = options.start;
  setup.options.fuse.clear();
  for (const Channel channel : kEveryChannel)
    if (textOf(channel).is_filtered && channel != kChannel<Landmark>) setup.options.fuse.push_back(channel);
  setup.options.noise.sea_floor = 1e-6;  // it is flat
  std::vector<Sample> samples;
  simulateNavigation(options, trajectory, [&](const Sample& s) { samples.push_back(s); });
  std::size_t next = 0;
  double error_m = 0, error_rad = 0;
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& e) {
    if (e.t_s < 10) return;
    const auto truth = trajectory.at(e.t_s);
    error_m = std::max(error_m, (e.state.motion.position_odom - truth.position_odom).norm());
    error_rad = std::max(error_rad, angleBetween(e.state.motion.R_odom_robot, truth.R_odom_robot));
  };
  const LocalizationSummary summary = localize(
      setup, [&] { return next < samples.size() ? std::optional(samples[next++]) : std::nullopt; }, sink);
  for (const auto* id : {"heading", "gnss", "altimeter"}) {
    const auto found = std::find_if(summary.channels.begin(), summary.channels.end(),
                                    [&](const auto& c) { return nameOf(c.first) == id; });
    ASSERT_NE(found, summary.channels.end()) << id;
    const ChannelSummary& s = found->second;
    const double half = 2 * (s.nis_band95_high - s.degrees_of_freedom);
    EXPECT_NEAR(s.nis_mean, s.degrees_of_freedom, half) << id;
    EXPECT_LT(s.gated, s.fused / 50) << id;
  }
  EXPECT_LT(error_m, 1.0);
  EXPECT_LT(error_rad, radians(1.5));
}

}  // namespace
}  // namespace fathom
