// The localizer's dealings with its input: late, doubled, broken and missing readings.
#include "localization/localizer.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "localization/evaluation.h"
#include "simulation/navigation_simulator.h"
#include "simulation/read_trajectory.h"

namespace fathom {
namespace {

struct Outcome {
  LocalizationSummary summary;
  std::vector<Estimate> estimates, smoothed;
  std::vector<Event> events;
};

class LocalizerTest : public testing::Test {
 protected:
  LocalizerTest() {
    simulation_.vehicle = readVehicle(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/rov.yaml");
    simulation_.duration_s = 40.0;
    simulation_.sea_floor_z_m = -6.0;
    simulation_.seed = 3;
    const Trajectory trajectory =
        readTrajectory(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/dive_trajectory.yaml");
    simulateNavigation(simulation_, trajectory, [this](const Sample& sample) {
      if (sample.label == labels::kTruth)
        truth_.push_back({sample.time, std::get<PoseSample>(sample.reading).T_odom_robot.mean});
      else
        samples_.push_back(sample);
    });
    setup_.vehicle = simulation_.vehicle;
    setup_.time_zero = samples_.front().time;
    setup_.start = StartPose{.T_odom_robot = truth_.front().T_odom_robot};
  }

  Outcome run(const std::vector<Sample>& samples) const {
    Outcome outcome;
    LocalizationSink sink;
    sink.estimate = [&](const Estimate& e) { outcome.estimates.push_back(e); };
    sink.smoothed = [&](const Estimate& e) { outcome.smoothed.push_back(e); };
    sink.event = [&](const Event& e) { outcome.events.push_back(e); };
    std::size_t k = 0;
    outcome.summary = localize(
        setup_,
        [&]() -> std::optional<Sample> {
          if (k == samples.size()) return std::nullopt;
          return samples[k++];
        },
        sink);
    return outcome;
  }

  double finalError(const Outcome& outcome) const {
    const auto truth = poseAt(truth_, outcome.estimates.back().time);
    return truth ? (outcome.estimates.back().state.motion.position_odom - truth->position).norm() : 1e9;
  }

  SimulationOptions simulation_;
  std::vector<StampedPose> truth_;
  std::vector<Sample> samples_;
  LocalizationSetup setup_;
};

TEST_F(LocalizerTest, FollowsTheTruth) {
  const Outcome outcome = run(samples_);
  ASSERT_TRUE(outcome.summary.started);
  // 40 s at 0.5 m/s: the start's 0.1 m and 0.5 degrees, and 1 cm/s of DVL noise averaged over 200 readings.
  EXPECT_LT(finalError(outcome), 0.3);
  EXPECT_EQ(outcome.summary.event_counts.size(), 1u) << "only the start";
}

// What no vehicle does and no sea allows is named and left out, however often it comes.
TEST_F(LocalizerTest, ImpossibleValuesAreLeftOut) {
  std::vector<Sample> samples = samples_;
  std::size_t broken = 0;
  for (std::size_t k = 0; k < samples.size(); k += 3) {
    auto& reading = samples[k].reading;
    if (auto* ins = std::get_if<InsSample>(&reading))
      ins->angular_velocity_ins = Vector3d(1e20, 0, 0);
    else if (auto* dvl = std::get_if<DvlSample>(&reading))
      dvl->velocity_dvl = Vector3d(0, -60, 0);
    else if (auto* beams = std::get_if<DvlBeamsSample>(&reading))
      beams->beams.front().range_m = -1.0;
    else if (auto* depth = std::get_if<DepthSample>(&reading))
      depth->pressure_pa = 1e9;
    else
      continue;
    ++broken;
  }
  const Outcome outcome = run(samples);
  EXPECT_GT(broken, 1000u);
  EXPECT_EQ(outcome.summary.event_counts.at("impossible"), broken);
  EXPECT_LT(finalError(outcome), 0.3) << "as with all readings: two of three are left";
}

// Every other DVL reading says something else that is possible, and is rejected; they are as many as those
// that are believed after being rejected again and again, but do not agree with each other.
TEST_F(LocalizerTest, GarbageIsNotBelieved) {
  std::vector<Sample> samples = samples_;
  Random random(5);
  bool next = true;
  for (Sample& sample : samples)
    if (auto* dvl = std::get_if<DvlSample>(&sample.reading)) {
      const double t_s = secondsBetween(setup_.time_zero, sample.time);
      const bool burst = t_s > 10.0 && t_s < 14.0;  // twenty in a row
      if ((burst || std::exchange(next, !next)) && t_s > 5.0) dvl->velocity_dvl = 8.0 * random.normal3();
    }
  const Outcome outcome = run(samples);
  EXPECT_GT(outcome.summary.channels.at(kChannel<Dvl>).gated, 80u);
  EXPECT_LT(finalError(outcome), 0.5);
}

// A DVL that arrives 0.5 s late is fused at its own time: the result is that of the ordered stream, to
// rounding.
TEST_F(LocalizerTest, LateReadingsChangeNothing) {
  std::vector<Sample> late;
  std::vector<Sample> held;
  for (const Sample& sample : samples_) {
    if (sample.label == labels::kDvl) {
      held.push_back(sample);
      continue;
    }
    while (!held.empty() && secondsBetween(held.front().time, sample.time) > 0.5) {
      late.push_back(held.front());
      held.erase(held.begin());
    }
    late.push_back(sample);
  }
  late.insert(late.end(), held.begin(), held.end());
  std::vector<Sample> ordered = samples_;
  // Readings of one instant are fused in order of arrival; put the DVL last there, as the late stream does.
  std::stable_sort(ordered.begin(), ordered.end(), [](const Sample& a, const Sample& b) {
    return a.time != b.time ? a.time < b.time : a.label != labels::kDvl && b.label == labels::kDvl;
  });
  // The alignment looks at the first readings; give both runs the same.
  const Outcome expected = run(ordered), outcome = run(late);
  EXPECT_GT(outcome.summary.late_fused, 150u);
  const Vector3d gap = outcome.estimates.back().state.motion.position_odom -
                       expected.estimates.back().state.motion.position_odom;
  // The first DVL readings start the velocity a little differently, which is forgotten but for some
  // millimetres.
  EXPECT_LT(gap.norm(), 0.01);
}

// One ping gives a DVL's velocity and its beams' ranges: stamps that are late by a known latency change
// nothing.
TEST_F(LocalizerTest, CalibratedLatencyMovesVelocityAndBeams) {
  setup_.options.fuse.push_back(kChannel<DvlBeams>);
  setup_.options.bias_states = true;
  const Outcome expected = run(samples_);
  constexpr double kLatency_s = 0.437;  // between the INS's readings
  setup_.calibration.add<DvlLatency>({kLatency_s});
  std::vector<Sample> late;
  for (const Sample& sample : samples_)
    if (sample.label != labels::kDvl && sample.label != labels::kDvlBeams) late.push_back(sample);
  for (const Sample& sample : samples_)
    if (sample.label == labels::kDvl || sample.label == labels::kDvlBeams) {
      late.push_back(sample);
      late.back().time = after(sample.time, kLatency_s);
    }
  std::stable_sort(late.begin(), late.end(),
                   [](const Sample& a, const Sample& b) { return a.time < b.time; });
  const Outcome outcome = run(late);
  EXPECT_GT(outcome.summary.channels.at(kChannel<DvlBeams>).fused, 700u);
  const auto& a = expected.estimates.back().state;
  const auto& b = outcome.estimates.back().state;
  // The filter knows height to a millimetre here; fused 0.44 s late at 0.1 m/s up or down it would be off
  // by 40.
  EXPECT_LT((a.motion.position_odom - b.motion.position_odom).norm(), 0.01);
  EXPECT_NEAR(a.sea_floor_z_m, b.sea_floor_z_m, 0.01);
}

TEST_F(LocalizerTest, NamesWhatIsWrongWithTheInput) {
  std::vector<Sample> bad;
  for (const Sample& sample : samples_) {
    const double t_s = secondsBetween(setup_.time_zero, sample.time);
    if (t_s > 10.0 && t_s < 13.0) continue;                                  // every sensor silent
    if (sample.label == labels::kDvl && t_s > 20.0 && t_s < 28.0) continue;  // one sensor silent
    bad.push_back(sample);
    if (sample.label == labels::kIns && t_s > 15.0 && t_s < 15.1) bad.push_back(sample);  // doubled
    if (sample.label == labels::kIns && t_s > 16.0 && t_s < 16.1)
      std::get<InsSample>(bad.back().reading).angular_velocity_ins->x() = std::nan("");
    if (t_s > 30.0 && t_s < 30.02 && sample.label == labels::kIns) {
      bad.push_back(sample);
      bad.back().time = after(setup_.time_zero, 5.0 + 0.001 * t_s);  // time jumps back by 25 s
    }
  }
  const Outcome outcome = run(bad);
  const auto& counts = outcome.summary.event_counts;
  for (const char* kind : {"gap", "silent", "duplicate", "not-a-number", "time-jump", "too-late"})
    EXPECT_TRUE(counts.contains(kind)) << kind;
  for (const Estimate& e : outcome.estimates) ASSERT_TRUE(e.state.motion.position_odom.allFinite());
  EXPECT_LT(finalError(outcome), 2.0);
}

// A DVL that lies by 2 m/s for a second is an outlier; one that keeps contradicting the filter is named.
TEST_F(LocalizerTest, GatesOutliersAndNamesContradiction) {
  auto outliers = samples_, contradiction = samples_;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const double t_s = secondsBetween(setup_.time_zero, samples_[k].time);
    if (samples_[k].label != labels::kDvl) continue;
    if (t_s > 20.0 && t_s < 20.7) std::get<DvlSample>(outliers[k].reading).velocity_dvl->x() += 2.0;
    if (t_s > 20.0) std::get<DvlSample>(contradiction[k].reading).velocity_dvl->x() += 2.0;
  }
  const Outcome clean = run(samples_), gated = run(outliers), contradicted = run(contradiction);
  EXPECT_GE(gated.summary.channels.at(kChannel<Dvl>).gated, 3u);
  EXPECT_LT(finalError(gated), finalError(clean) + 0.1);
  EXPECT_TRUE(contradicted.summary.event_counts.contains("rejected"));
}

TEST_F(LocalizerTest, SmootherIsNoWorseAndSurer) {
  setup_.options.smooth = true;
  const Outcome outcome = run(samples_);
  ASSERT_EQ(outcome.smoothed.size(), outcome.estimates.size());
  double filter = 0.0, smoother = 0.0;
  for (std::size_t k = 0; k < outcome.estimates.size(); ++k) {
    EXPECT_LE(outcome.smoothed[k].pose_covariance.trace(),
              outcome.estimates[k].pose_covariance.trace() * (1.0 + 1e-9));
    const auto& f = outcome.estimates[k].state.motion;
    const auto& s = outcome.smoothed[k].state.motion;
    if (k + 1 == outcome.estimates.size()) {  // at the end there is nothing to look back from
      EXPECT_LT((f.position_odom - s.position_odom).norm(), 1e-6);
    }
    const auto truth = poseAt(truth_, outcome.estimates[k].time);
    if (!truth) continue;
    filter += (truth->rotation.transpose() * f.R_odom_robot - Matrix3d::Identity()).squaredNorm();
    smoother += (truth->rotation.transpose() * s.R_odom_robot - Matrix3d::Identity()).squaredNorm();
  }
  EXPECT_LT(smoother, 1.05 * filter);
}

}  // namespace
}  // namespace fathom
