#include "sources/degradation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "support/streams.h"

namespace fathom {
namespace {

using test::at;
using test::completeFingerprints;
using test::degraded;
using test::everySensor;
using test::labelled;
using test::LandmarkScene;
using test::stage;

/// DVL samples that move by (1, 2, 3) m/s, 10 Hz.
std::vector<Sample> dvlSamples(int count) {
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i)
    samples.push_back({at(0.1 * i), labels::kDvl, DvlSample{{}, Vector3d(1, 2, 3)}});
  return samples;
}
Vector3d velocity(const Sample& sample) { return std::get<DvlSample>(sample.reading).velocity_dvl.value(); }
double stamp(const Sample& sample) { return secondsBetween(test::kStart, sample.time); }

/// DVL and INS in turn, 10 Hz each.
std::vector<Sample> twoSensors(int count) {
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back({at(0.1 * i), labels::kDvl, DvlSample{{}, Vector3d(1, 2, 3)}});
    samples.push_back(
        {at(0.1 * i + 0.05), labels::kIns, InsSample{{}, Vector3d(1, 2, 3), Vector3d(4, 5, 6), {}}});
  }
  return samples;
}

// ---- what becomes of the stream

TEST(Degradation, DropLosesItsShareAndAStrongerOneLosesThoseToo) {
  const auto samples = dvlSamples(4000);
  const auto left = [&](double p) {
    std::set<Time> times;
    for (const Sample& s :
         degraded(samples, {stage("kind: drop, sensors: [DVL], probability: " + std::to_string(p))}))
      times.insert(s.time);
    return times;
  };
  const auto most = left(0.2), few = left(0.7);
  EXPECT_NEAR(static_cast<double>(most.size()), 3200,
              4 * std::sqrt(4000 * 0.2 * 0.8));  // 4 sigma of a binomial
  EXPECT_NEAR(static_cast<double>(few.size()), 1200, 4 * std::sqrt(4000 * 0.7 * 0.3));
  EXPECT_TRUE(std::includes(most.begin(), most.end(), few.begin(), few.end()));
  EXPECT_TRUE(left(1.0).empty());
}

TEST(Degradation, DelayKeepsStampsAndArrivesBehindLaterOnes) {
  const auto out = degraded(twoSensors(20), {stage("kind: delay, sensors: [DVL], delay_s: 0.32")});
  ASSERT_EQ(out.size(), 40U);
  double newest = 0;
  for (const Sample& s : out) {
    if (s.label == labels::kIns) newest = stamp(s);
    // Released by the first INS sample at or after stamp + 0.32; at the end of the stream, at once.
    if (s.label == labels::kDvl && stamp(s) < 1.6) {
      EXPECT_GE(newest, stamp(s) + 0.32 - 0.1);
      EXPECT_LE(newest, stamp(s) + 0.32);
    }
  }
  EXPECT_EQ(completeFingerprints(labelled(out, labels::kDvl)),
            completeFingerprints(labelled(twoSensors(20), labels::kDvl)));
}

TEST(Degradation, DelaysAddUp) {
  const auto once = degraded(twoSensors(50), {stage("kind: delay, sensors: [DVL], delay_s: 0.6")});
  const auto twice = degraded(twoSensors(50), {stage("kind: delay, sensors: [DVL], delay_s: 0.4"),
                                               stage("kind: delay, sensors: [DVL], delay_s: 0.2")});
  EXPECT_EQ(completeFingerprints(once), completeFingerprints(twice));
}

TEST(Degradation, JitterIsOfTheStampAndLeavesTheOrder) {
  const auto samples = dvlSamples(4000);
  const auto out = degraded(samples, {stage("kind: jitter, sensors: [DVL], sigma_s: 0.03")});
  ASSERT_EQ(out.size(), samples.size());
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double error_s = secondsBetween(samples[i].time, out[i].time);
    mean += error_s / 4000;
    square += error_s * error_s / 4000;
  }
  EXPECT_NEAR(mean, 0, 4 * 0.03 / std::sqrt(4000));
  EXPECT_NEAR(std::sqrt(square), 0.03, 4 * 0.03 / std::sqrt(2 * 4000));
}

TEST(Degradation, OutageIsAWindowAndRepeats) {
  const auto silent = [](const std::string& keys) {
    std::set<int> tenths;
    for (int i = 0; i < 300; ++i) tenths.insert(i);
    for (const Sample& s : degraded(dvlSamples(300), {stage("kind: outage, sensors: [DVL], " + keys)}))
      tenths.erase(static_cast<int>(std::lround(10 * stamp(s))));
    return tenths;
  };
  const auto range = [](int begin, int end, std::set<int> tenths = {}) {
    for (int i = begin; i < end; ++i) tenths.insert(i);
    return tenths;
  };
  EXPECT_EQ(silent("begin_s: 4.95, duration_s: 2"), range(50, 70));
  EXPECT_EQ(silent("begin_s: 4.95, duration_s: 2, repeat_s: 10"),
            range(50, 70, range(150, 170, range(250, 270))));
  EXPECT_EQ(silent("begin_s: 4.95, duration_s: 2, repeat_s: 10, end_s: 16.05"),
            range(50, 70, range(150, 161)));
  EXPECT_EQ(silent("duration_s: 1"), range(0, 10));
}

TEST(Degradation, EveryStageHasItsWindow) {
  const auto out = degraded(
      dvlSamples(100), {stage("kind: bias, sensors: [DVL], velocity_m_s: 1, begin_s: 2.95, end_s: 4.95")});
  for (const Sample& s : out)
    EXPECT_EQ(velocity(s).x(), stamp(s) > 2.95 && stamp(s) < 4.95 ? 2.0 : 1.0) << stamp(s);
}

TEST(Degradation, DuplicateComesRightBehindOrLater) {
  const auto samples = dvlSamples(1000);
  const auto all = degraded(samples, {stage("kind: duplicate, sensors: [DVL], probability: 1")});
  ASSERT_EQ(all.size(), 2000U);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].time, samples[i / 2].time);
  const auto some = degraded(samples, {stage("kind: duplicate, sensors: [DVL], probability: 0.3")});
  EXPECT_NEAR(static_cast<double>(some.size()), 1300, 4 * std::sqrt(1000 * 0.3 * 0.7));
  const auto later =
      degraded(samples, {stage("kind: duplicate, sensors: [DVL], probability: 1, after_s: 0.25")});
  // stamps 0 1 2 (0) 3 (1) 4 …: a copy comes out with the first sample 0.25 s later
  EXPECT_NEAR(stamp(later[0]), 0.0, 1e-6);
  EXPECT_NEAR(stamp(later[2]), 0.2, 1e-6);
  EXPECT_NEAR(stamp(later[3]), 0.0, 1e-6);
}

TEST(Degradation, ReorderHoldsUpSomeForAWhile) {
  const auto samples = dvlSamples(1000);
  const auto out =
      degraded(samples, {stage("kind: reorder, sensors: [DVL], probability: 0.2, within_s: 0.45")});
  ASSERT_EQ(out.size(), samples.size());
  double newest = 0;
  int late = 0;
  for (const Sample& s : out) {
    if (stamp(s) < newest) ++late;
    EXPECT_GT(stamp(s), newest - 0.45 - 0.1);
    newest = std::max(newest, stamp(s));
  }
  // Those held up by less than the 0.1 s to the next stay: 7 of 9 of the 200 are overtaken, some by each
  // other.
  EXPECT_NEAR(late, 200 * 7 / 9.0, 40);
}

// ---- what becomes of values

TEST(Degradation, NoiseHasItsSigmaInEachAxis) {
  const auto out =
      degraded(dvlSamples(4000), {stage("kind: noise, sensors: [DVL], velocity_m_s: [0.1, 0.2, 0]")});
  Vector3d mean = Vector3d::Zero(), square = Vector3d::Zero();
  for (const Sample& s : out) {
    const Vector3d error = velocity(s) - Vector3d(1, 2, 3);
    mean += error / 4000;
    square += error.cwiseProduct(error) / 4000;
  }
  for (int i = 0; i < 2; ++i) {
    const double sigma = 0.1 * (i + 1);
    EXPECT_NEAR(mean[i], 0, 4 * sigma / std::sqrt(4000));
    EXPECT_NEAR(std::sqrt(square[i]), sigma, 4 * sigma / std::sqrt(2 * 4000));
  }
  EXPECT_EQ(square.z(), 0.0);
}

TEST(Degradation, BiasIsWhatItSays) {
  Random random(3);
  const Pose T = test::randomPose(random);
  PoseSample usbl;
  usbl.T_odom_robot.mean = T;
  const std::vector<Sample> samples{
      {at(0), labels::kIns, InsSample{{}, Vector3d(1, 2, 3), Vector3d(4, 5, 6), T.rotation}},
      {at(0), labels::kDvl, DvlSample{{}, {}}},
      {at(0), labels::kDvlBeams, DvlBeamsSample{{{{}, 2.0}, {{}, {}}, {{}, 0.1}}}},
      {at(0), labels::kDepth, DepthSample{{}, 2e5, {}}},
      {at(0), labels::kUsbl, usbl}};
  const auto out = degraded(
      samples, {stage("kind: bias, sensors: [INS], gyro_rad_s: 0.5, accelerometer_m_s2: [0, 1, 0], "
                      "attitude_deg: [0, 0, 90]"),
                stage("kind: bias, sensors: [DVL, DVL_BEAMS], velocity_m_s: 1, range_m: -0.5"),
                stage("kind: bias, sensors: [DEPTH, USBL], pressure_pa: 100, position_m: [1, 2, 3]")});
  const auto& ins = std::get<InsSample>(out[0].reading);
  EXPECT_EQ(*ins.angular_velocity_ins, Vector3d(1.5, 2.5, 3.5));
  EXPECT_EQ(*ins.specific_force_ins, Vector3d(4, 6, 6));
  EXPECT_LT((ins.R_odom_ins->col(0) - T.rotation.col(1)).norm(), 1e-12);  // x now points where y did
  EXPECT_FALSE(std::get<DvlSample>(out[1].reading).velocity_dvl);         // what is absent stays so
  const auto& beams = std::get<DvlBeamsSample>(out[2].reading).beams;
  EXPECT_EQ(beams[0].range_m, 1.5);
  EXPECT_FALSE(beams[1].range_m);
  EXPECT_EQ(beams[2].range_m, 1e-3);  // 0 would be "no echo"
  EXPECT_EQ(std::get<DepthSample>(out[3].reading).pressure_pa, 200100);
  const auto& moved = std::get<PoseSample>(out[4].reading).T_odom_robot.mean;
  EXPECT_LT((moved.position - T.position - Vector3d(1, 2, 3)).norm(), 1e-12);
}

TEST(Degradation, CorruptValuesAreGarbageOfTheKindsAsked) {
  const auto kinds = [](const std::string& as) {
    std::map<std::string, int> count;
    for (const Sample& s :
         degraded(dvlSamples(3000), {stage("kind: corrupt, sensors: [DVL], probability: 0.5" + as)})) {
      const Vector3d v = velocity(s);
      if (v.array().isNaN().all())
        ++count["nan"];
      else if ((v.array().abs() == 1e12).all())
        ++count["huge"];
      else if (v == Vector3d(1, 2, 3))
        ++count["sound"];
      else if (v.cwiseAbs().maxCoeff() <= 3.0)
        ++count["wild"];
    }
    return count;
  };
  auto all = kinds("");
  EXPECT_NEAR(all["sound"], 1500, 4 * std::sqrt(3000 * 0.25));
  for (const char* kind : {"nan", "huge", "wild"})
    EXPECT_NEAR(all[kind], 500, 4 * std::sqrt(3000 / 6.0)) << kind;
  EXPECT_EQ(all["nan"] + all["huge"] + all["wild"] + all["sound"], 3000);
  auto wild = kinds(", as: [wild]");
  EXPECT_EQ(wild["wild"] + wild["sound"], 3000);
  EXPECT_GT(wild["wild"], 0);
}

// ---- landmarks: two forms of one image

std::vector<Sample> landmarks(int count) {
  const LandmarkScene scene;
  Random random(7);
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const Pose T_odom_robot = test::randomPose(random);
    samples.push_back(scene.markers(at(i), T_odom_robot));
    samples.push_back(scene.panel(at(i), T_odom_robot));
  }
  return samples;
}

TEST(Degradation, LandmarkBiasMovesTheRobotInItsOwnAxesInBothForms) {
  const LandmarkScene scene;
  const auto samples = landmarks(20);
  const auto out = degraded(
      samples,
      {stage("kind: bias, sensors: [LANDMARKS], position_m: [0.1, 0.2, 0.3], angle_deg: [0, 0, 10]")});
  const Pose D{rotationFromYawPitchRoll(radians(10), 0, 0), {0.1, 0.2, 0.3}};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Pose expected = scene.robot(samples[i]) * D, got = scene.robot(out[i]);
    EXPECT_LT((expected.position - got.position).norm(), 1e-9) << i;
    EXPECT_LT(angleBetween(expected.rotation, got.rotation), 1e-9) << i;
  }
}

TEST(Degradation, BothFormsOfAnImageShareTheirFate) {
  const LandmarkScene scene;
  const auto samples = landmarks(300);
  const std::vector<std::string> stages{"kind: drop, probability: 0.4",
                                        "kind: jitter, sigma_s: 0.1",
                                        "kind: noise, position_m: 0.1, angle_deg: 5",
                                        "kind: corrupt, probability: 0.5, as: [wild, huge]",
                                        "kind: duplicate, probability: 0.5",
                                        "kind: reorder, probability: 0.5, within_s: 3"};
  for (const std::string& keys : stages) {
    const auto out = degraded(samples, {stage(keys + ", sensors: [LANDMARKS]")});
    const auto markers = labelled(out, labels::kMarkers), panels = labelled(out, labels::kPanel);
    ASSERT_EQ(markers.size(), panels.size()) << keys;
    for (std::size_t i = 0; i < markers.size(); ++i) {
      EXPECT_EQ(markers[i].time, panels[i].time) << keys;
      const Pose a = scene.robot(markers[i]), b = scene.robot(panels[i]);
      // 1e12 m lose all but their first 16 digits on their way through the camera's frame.
      EXPECT_LT((a.position - b.position).norm(), 1e-9 + 1e-14 * a.position.norm()) << keys;
      EXPECT_LT(angleBetween(a.rotation, b.rotation), 1e-6) << keys;
    }
  }
}

TEST(Degradation, AFormAloneMeetsTheFateOfBoth) {
  const auto samples = landmarks(300);
  const auto drop = stage("kind: drop, sensors: [LANDMARKS], probability: 0.4");
  EXPECT_EQ(completeFingerprints(degraded(labelled(samples, labels::kPanel), {drop})),
            completeFingerprints(labelled(degraded(samples, {drop}), labels::kPanel)));
}

// ---- the stream as a whole

TEST(Degradation, StagesOfOneSeedDrawDifferently) {
  const auto drop = stage("kind: drop, sensors: [DVL], probability: 0.5");
  const auto left = degraded(dvlSamples(1000), {drop, drop}).size();
  EXPECT_NEAR(static_cast<double>(left), 250, 4 * std::sqrt(1000 * 0.25 * 0.75));
}

TEST(Degradation, ASensorsFateDoesNotDependOnOthers) {
  const auto drop = stage("kind: drop, sensors: [DVL, INS], probability: 0.5");
  const auto samples = twoSensors(200);
  EXPECT_EQ(completeFingerprints(degraded(labelled(samples, labels::kDvl), {drop})),
            completeFingerprints(labelled(degraded(samples, {drop}), labels::kDvl)));
}

TEST(Degradation, ABrokenStampNeitherFreesNorHoldsWhatIsDelayed) {
  auto samples = twoSensors(100);
  samples[60].time = at(1e8);  // three years ahead
  samples[80].time = at(-1e8);
  const auto out = degraded(samples, {stage("kind: delay, sensors: [DVL], delay_s: 0.32")});
  ASSERT_EQ(out.size(), samples.size());
  double newest = 0;
  for (const Sample& s : out) {
    if (std::abs(stamp(s)) > 1e6) continue;
    if (s.label == labels::kIns) newest = stamp(s);
    if (s.label == labels::kDvl && stamp(s) < 9.5) {
      EXPECT_GT(newest, stamp(s) + 0.1);  // a broken stamp takes the place of one, so the clock lacks a tick
      EXPECT_LT(newest, stamp(s) + 0.7);
    }
  }
}

TEST(Degradation, HeldSamplesAreBounded) {
  // Without a running clock nothing falls due; the end brings all.
  std::vector<Sample> samples(1000, Sample{at(0), labels::kDepth, DepthSample{}});
  EXPECT_EQ(degraded(samples, {stage("kind: delay, sensors: [DEPTH], delay_s: 1")}).size(), 1000U);
  class Endless : public test::ListSource {
   public:
    Endless() : ListSource({}) {}
    std::optional<Sample> next() override {
      ++given;
      return Sample{at(0), labels::kDepth, DepthSample{}};
    }
    std::size_t given = 0;
  };
  auto endless = std::make_unique<Endless>();
  const Endless& counter = *endless;
  DegradedSource source(std::move(endless), {stage("kind: delay, sensors: [DEPTH], delay_s: 1")});
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(source.next());
  EXPECT_LE(counter.given, DegradedSource::kMostHeld + 11);
}

TEST(Degradation, WhatASourceSaysOfItselfPasses) {
  DegradedSource source(std::make_unique<test::ListSource>(dvlSamples(4)), {});
  EXPECT_EQ(source.header().description, "a list");
  EXPECT_EQ(source.imageFolder(), "/images");
  source.next();
  EXPECT_EQ(source.fraction(), 0.25);
  EXPECT_FALSE(source.loss());
}

}  // namespace
}  // namespace fathom
