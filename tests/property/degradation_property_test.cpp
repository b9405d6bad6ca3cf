// Laws that every registered kind of fault obeys, whichever kinds there are.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "sources/degradation.h"
#include "support/streams.h"

namespace fathom {
namespace {

using test::completeFingerprint;
using test::completeFingerprints;
using test::degraded;
using test::everySensor;

/// Sensors with values, two of them with two forms or several beams.
const std::vector<std::string> kSensors{labels::kIns, labels::kDvlBeams, labels::kUsbl, kLandmarks};

/// Every kind with all its strengths at one value.
std::vector<DegradationStage> everyKind(double strength) {
  std::vector<DegradationStage> stages;
  forEachFault([&]<class Fault>() {
    DegradationStage stage{.fault = Fault{}, .sensors = kSensors, .seed = 5};
    for (const std::string& key : stage.strengthKeys()) stage = stage.with(key, strength);
    stages.push_back(stage);
  });
  return stages;
}

TEST(DegradationLaws, EveryKindHasAStrengthAndItsOwnName) {
  std::set<std::string> names;
  for (const DegradationStage& stage : everyKind(0.5)) {
    EXPECT_FALSE(stage.strengthKeys().empty()) << stage.kind();
    EXPECT_TRUE(names.insert(stage.kind()).second) << stage.kind();
  }
  EXPECT_EQ(names.size(), std::variant_size_v<AnyFault>);
}

TEST(DegradationLaws, StrengthZeroChangesNothingAndHalfDoes) {
  const auto samples = everySensor(30);
  const auto before = completeFingerprints(samples);
  for (const DegradationStage& stage : everyKind(0.5)) {
    EXPECT_EQ(completeFingerprints(degraded(samples, {stage.scaled(0)})), before) << stage.kind();
    EXPECT_NE(completeFingerprints(degraded(samples, {stage})), before) << stage.kind();
  }
  EXPECT_EQ(completeFingerprints(degraded(samples, everyKind(0))), before);
}

TEST(DegradationLaws, TheSameSeedGivesTheSameSamplesAndAnotherOneDoesNot) {
  const auto samples = everySensor(30);
  for (DegradationStage stage : everyKind(0.5)) {
    const auto once = completeFingerprints(degraded(samples, {stage}));
    EXPECT_EQ(completeFingerprints(degraded(samples, {stage})), once) << stage.kind();
    const std::set<std::string> certain{"delay", "bias", "outage", "clock", "swing"};
    const bool random = !certain.contains(stage.kind());
    stage.seed = 6;
    EXPECT_EQ(completeFingerprints(degraded(samples, {stage})) != once, random) << stage.kind();
  }
}

TEST(DegradationLaws, OtherSensorsAreNotTouched) {
  const auto samples = everySensor(30);
  for (const DegradationStage& stage : everyKind(0.5)) {
    const auto other = [&](const Sample& s) { return !stage.concerns(s.label); };
    EXPECT_EQ(test::fingerprintsWhere(degraded(samples, {stage}), other),
              test::fingerprintsWhere(samples, other))
        << stage.kind();
  }
}

TEST(DegradationLaws, OutsideItsWindowAStageDoesNothing) {
  const auto samples = everySensor(30);
  for (DegradationStage stage : everyKind(0.5)) {
    stage.begin_s = 10;
    stage.end_s = 12;
    // Delays of up to half a second reach beyond the window's end in the order of arrival, jitter both ways.
    const auto outside = [&](const Sample& s) {
      const double t = secondsBetween(test::kStart, s.time);
      return t < 8 || t > 14;
    };
    EXPECT_EQ(test::fingerprintsWhere(degraded(samples, {stage}), outside),
              test::fingerprintsWhere(samples, outside))
        << stage.kind();
  }
}

// Arrival: no sample comes before its turn, so what has no delay keeps the order of the source.
TEST(DegradationLaws, NothingIsInventedAndNothingArrivesEarly) {
  const auto samples = everySensor(30);
  for (const DegradationStage& stage : everyKind(0.5)) {
    if (stage.kind() == "jitter" || stage.kind() == "clock")
      continue;  // their stamps are not when samples arrive
    std::map<std::pair<Time, std::string>, std::size_t> place;
    for (std::size_t i = 0; i < samples.size(); ++i) place[{samples[i].time, samples[i].label}] = i;
    double newest = 0;
    std::map<std::string, double> untouched_until;
    for (const Sample& s : degraded(samples, {stage})) {
      ASSERT_TRUE(place.contains({s.time, s.label})) << stage.kind();
      const double t = secondsBetween(test::kStart, s.time);
      if (!stage.concerns(s.label)) {
        EXPECT_GE(t, untouched_until[s.label]) << stage.kind();
        untouched_until[s.label] = newest = std::max(newest, t);
      }
      EXPECT_LE(t, newest + 0.5)
          << stage.kind();  // never ahead of the clock, which others show twice a second
    }
  }
}

/// Stamps and values that no sensor should give.
std::vector<Sample> broken(std::uint64_t seed) {
  Random random(seed);
  auto samples = everySensor(5, seed);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (Sample& s : samples) {
    const double what = random.uniform();
    if (what < 0.02) s.time = Time{};
    if (what > 0.98) s.time = Time{Time::duration{static_cast<Time::duration::rep>(random.bits())}};
    if (what > 0.3 && what < 0.32) s.reading = UnknownSample{"CObservationOdometry"};
    if (what > 0.4 && what < 0.42) s.reading = DvlSample{{}, Vector3d(kNaN, 1e308, -1e308)};
    if (what > 0.5 && what < 0.52) s.reading = DvlBeamsSample{};
    if (what > 0.6 && what < 0.62) s.reading = PanelSample{};
    if (what > 0.7 && what < 0.72) s.reading = DepthSample{{}, kNaN, {}};
    if (what > 0.8 && what < 0.82) s.reading = RecordingHeader{};
    if (what > 0.9 && what < 0.92) s.label = "";
  }
  return samples;
}

TEST(DegradationLaws, NoInputAndNoStrengthBreaksThem) {
  const std::vector<std::string> all{labels::kIns,    labels::kDvl,     labels::kDvlBeams,
                                     labels::kDepth,  labels::kUsbl,    labels::kCamera,
                                     labels::kStereo, labels::kMarkers, labels::kPanel};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto samples = broken(seed);
    for (const double strength : {0.0, 0.5, 1.0})
      for (const double factor : {1.0, 1e3, 1e300}) {
        auto stages = everyKind(strength);
        for (DegradationStage& stage : stages) {
          stage.sensors = all;
          stage = stage.scaled(factor);
          EXPECT_LE(degraded(samples, {stage}).size(), 2 * samples.size()) << stage.kind();
        }
        EXPECT_LE(degraded(samples, stages).size(), 2 * samples.size());
      }
  }
}

TEST(DegradationLaws, ChainedStagesAreDeterministicToo) {
  const auto samples = everySensor(20);
  const auto stages = everyKind(0.3);
  EXPECT_EQ(completeFingerprints(degraded(samples, stages)), completeFingerprints(degraded(samples, stages)));
}

}  // namespace
}  // namespace fathom
