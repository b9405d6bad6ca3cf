// Tasks side by side give what each gives alone, and the hooks see the samples as they go by.
#include "localization/run_tasks.h"

#include <gtest/gtest.h>

#include <deque>

#include "core/error.h"
#include "simulation/navigation_simulator.h"
#include "simulation/read_trajectory.h"
#include "support/shipped.h"
#include "support/streams.h"

namespace fathom {
namespace {

/// All that a task gives, as numbers and text.
struct TaskTrace {
  std::vector<double> numbers;
  std::vector<std::string> events;
  double newest_t_s = -1.0;

  LocalizationSink sink() {
    LocalizationSink sink;
    sink.estimate = [this](const Estimate& e) {
      newest_t_s = e.t_s;
      add(e);
    };
    sink.smoothed = [this](const Estimate& e) { add(e); };
    sink.innovation = [this](const Innovation& i) {
      numbers.insert(numbers.end(), {i.t_s, i.nis, i.fused ? 1.0 : 0.0});
    };
    sink.event = [this](const Event& e) { events.push_back(std::to_string(e.t_s) + e.kind + e.text); };
    return sink;
  }

 private:
  void add(const Estimate& e) {
    const auto append = [this](const auto& m) {
      numbers.insert(numbers.end(), m.data(), m.data() + m.size());
    };
    numbers.push_back(e.t_s);
    append(e.state.motion.position_odom);
    append(e.state.motion.R_odom_robot);
    append(e.state.motion.velocity_robot);
    append(e.state.gyro_bias_rad_s);
    append(e.pose_covariance);
  }
};

/// A minute of the dive with a panel in view twice a second: more than one block of samples.
class RunTasks : public testing::Test {
 protected:
  RunTasks() {
    SimulationOptions simulation;
    simulation.vehicle = readVehicle(test::kRov);
    simulation.duration_s = 60.0;
    simulation.sea_floor_z_m = -6.0;
    const test::LandmarkScene scene;
    simulateNavigation(simulation, readTrajectory(test::kConfig / "dive_trajectory.yaml"),
                       [&](const Sample& sample) {
                         samples_.push_back(sample);
                         if (sample.label != labels::kTruth || truths_++ % 5 != 0) return;
                         const Pose T_odom_robot = std::get<PoseSample>(sample.reading).T_odom_robot.mean;
                         if (!start_) start_ = T_odom_robot;
                         samples_.push_back(scene.markers(sample.time, T_odom_robot));
                         samples_.push_back(scene.panel(sample.time, T_odom_robot));
                       });
    for (const char* name : {"TL1", "TL2", "TL3", "TL5"}) {
      LocalizationSetup setup;
      setup.vehicle = simulation.vehicle;
      setup.options = readLocalizationOptions(test::kConfig / (std::string(name) + ".yaml"));
      setup.start = StartPose{.T_odom_robot = *start_};
      setup.time_zero = samples_.front().time;
      setup.panels = {{"P", scene.T_odom_panel}};
      setups_.push_back(setup);
      setup.options = readLocalizationOptions(test::kConfig / "improved.yaml", setup.options);
      setups_.push_back(setup);
    }
  }

  /// Localizers for all setups, each with a trace of its own.
  std::vector<Localizer*> makeLocalizers() {
    std::vector<Localizer*> tasks;
    for (const LocalizationSetup& setup : setups_) {
      localizers_.emplace_back(setup, traces_.emplace_back().sink());
      tasks.push_back(&localizers_.back());
    }
    return tasks;
  }

  Time timeZero() const { return samples_.front().time; }

  std::vector<Sample> samples_;
  std::size_t truths_ = 0;
  std::optional<Pose> start_;
  std::vector<LocalizationSetup> setups_;
  std::deque<TaskTrace> traces_;
  std::deque<Localizer> localizers_;
};

TEST_F(RunTasks, EachGivesWhatItGivesAlone) {
  test::ListSource source(samples_);
  const auto summaries = runTasks(source, makeLocalizers(), timeZero());
  ASSERT_EQ(summaries.size(), setups_.size());
  for (std::size_t i = 0; i < setups_.size(); ++i) {
    test::ListSource own(samples_);
    TaskTrace alone;
    const LocalizationSummary summary = localize(
        setups_[i], [&] { return own.next(); }, alone.sink());
    ASSERT_TRUE(summary.started) << i;
    EXPECT_GT(alone.numbers.size(), 10'000U) << i;
    EXPECT_TRUE(alone.numbers == traces_[i].numbers) << i << ": not bit for bit";
    EXPECT_EQ(alone.events, traces_[i].events) << i;
    EXPECT_EQ(summary.samples, summaries[i].samples) << i;
    EXPECT_EQ(summary.end_t_s, summaries[i].end_t_s) << i;
  }
  EXPECT_FALSE(traces_[0].numbers == traces_[1].numbers) << "different tasks give different estimates";
}

TEST_F(RunTasks, HooksSeeEachSampleBeforeTheTasksDo) {
  const auto tasks = makeLocalizers();
  std::vector<std::string> seen;
  std::vector<double> blocks;
  double newest_t_s = 0.0;
  TaskHooks hooks;
  hooks.sample = [&](const Sample& sample) {
    seen.push_back(test::completeFingerprint(sample));
    newest_t_s = std::max(newest_t_s, secondsBetween(timeZero(), sample.time));
  };
  hooks.block = [&](double block_t_s) {
    EXPECT_EQ(block_t_s, newest_t_s);
    blocks.push_back(block_t_s);
    for (std::size_t i = 0; i < traces_.size(); ++i) {
      EXPECT_LE(traces_[i].newest_t_s, block_t_s) << i << " knows a sample that the hook has not seen";
      // It has got all of the block: what it holds back is its history, and an output period.
      EXPECT_GE(traces_[i].newest_t_s, block_t_s - setups_[i].options.history_s - 0.6) << i;
    }
  };
  test::ListSource source(samples_);
  runTasks(source, tasks, timeZero(), hooks);
  EXPECT_EQ(seen, test::completeFingerprints(samples_));
  ASSERT_GE(blocks.size(), 2U) << "the recording is too short to tell";
  EXPECT_TRUE(std::is_sorted(blocks.begin(), blocks.end()));
  EXPECT_NEAR(blocks.back(), 60.0, 0.1);
}

TEST_F(RunTasks, AHookMayStopTheRun) {
  std::size_t seen = 0;
  TaskHooks hooks;
  hooks.sample = [&](const Sample&) { ++seen; };
  hooks.block = [](double) { throw Error("a file", "", "enough"); };
  test::ListSource source(samples_);
  EXPECT_THROW(runTasks(source, makeLocalizers(), timeZero(), hooks), Error);
  EXPECT_GT(seen, 0U);
  EXPECT_LT(seen, samples_.size());
}

TEST_F(RunTasks, ABrokenSourceIsNotSilent) {
  struct Broken : test::ListSource {
    using test::ListSource::ListSource;
    std::optional<Sample> next() override {
      if (++given_ > 5000) throw Error("a file", "byte 7", "broken");
      return test::ListSource::next();
    }
    std::size_t given_ = 0;
  };
  Broken source(samples_);
  EXPECT_THROW(runTasks(source, makeLocalizers(), timeZero()), Error);
}

TEST_F(RunTasks, NothingToRunOn) {
  test::ListSource source({});
  int calls = 0;
  TaskHooks hooks;
  hooks.sample = [&](const Sample&) { ++calls; };
  hooks.block = [&](double) { ++calls; };
  const auto summaries = runTasks(source, makeLocalizers(), timeZero(), hooks);
  ASSERT_EQ(summaries.size(), setups_.size());
  for (const LocalizationSummary& summary : summaries) EXPECT_FALSE(summary.started);
  EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace fathom
