#include "tasks/stress_runs.h"

#include <atomic>
#include <mutex>

#include "core/parallel.h"
#include "core/progress.h"
#include "sources/degraded_source.h"

namespace fathom {
namespace {

struct Planned {
  std::string fault, vary;
  double strength = 0;
  std::vector<DegradationStage> stages;
};

std::vector<Planned> planOf(const std::vector<StressFault>& faults) {
  std::vector<Planned> plan{{"none", "", 0, {}}};
  for (const StressFault& fault : faults)
    for (const double strength : fault.strengths)
      plan.push_back({fault.name, fault.vary, strength, {fault.at(strength)}});
  return plan;
}

bool isNotable(const Event& event) {
  return event.kind == "lost" || event.kind == "found" || event.kind == "reacquired" ||
         event.kind == "panel-moved";
}

/// Judges the run by its errors and by what it said of itself.
void judge(StressRun& run) {
  double silent_since_s = -1, last_s = 0;
  bool harmed = false;
  for (std::size_t i = 0; i < run.errors.size(); ++i) {
    const PoseError& error = run.errors[i];
    const bool lost = run.lost[i], outside = error.nees > kStressBound;
    if (!lost) run.largest_unflagged_m = std::max(run.largest_unflagged_m, error.position_m.norm());
    if (lost && i > 0) run.lost_s += error.t_s - last_s;
    if (outside && !lost) {
      if (silent_since_s < 0) silent_since_s = error.t_s;
      run.longest_silent_s = std::max(run.longest_silent_s, error.t_s - silent_since_s);
    } else {
      silent_since_s = -1;
    }
    harmed = harmed || lost || run.longest_silent_s > kChance_s;
    last_s = error.t_s;
  }
  if (!run.summary.started || run.errors.empty()) return;
  run.final_error_m = run.errors.back().position_m.norm();
  const bool silent_at_end = silent_since_s >= 0 && last_s - silent_since_s > kChance_s;
  if (run.summary.lost_since_s)
    run.outcome = StressRun::Outcome::lost;
  else if (silent_at_end)
    run.outcome = StressRun::Outcome::silent;
  else
    run.outcome = harmed ? StressRun::Outcome::recovered : StressRun::Outcome::unharmed;
}

StressRun runOne(const LocalizationSetup& setup, std::unique_ptr<SampleSource> source, const Planned& plan,
                 const std::vector<StampedPose>& reference) {
  StressRun run;
  run.fault = plan.fault;
  run.vary = plan.vary;
  run.strength = plan.strength;
  if (!plan.stages.empty()) source = std::make_unique<DegradedSource>(std::move(source), plan.stages);
  Evaluator evaluator(reference);
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& e) {
    if (evaluator.add(e)) run.lost.push_back(e.lost);
  };
  sink.event = [&](const Event& e) {
    if (isNotable(e)) run.events.push_back(e);
  };
  Localizer localizer(setup, sink);
  while (const auto sample = source->next()) {
    if (interrupted()) throw Interrupted{};
    localizer.add(*sample);
  }
  run.summary = localizer.finish();
  if (auto evaluation = evaluator.finish()) run.errors = std::move(evaluation->errors);
  judge(run);
  return run;
}

}  // namespace

std::string nameOf(StressRun::Outcome outcome) {
  switch (outcome) {
    case StressRun::Outcome::unharmed:
      return "unharmed";
    case StressRun::Outcome::recovered:
      return "recovered";
    case StressRun::Outcome::lost:
      return "lost, and says so";
    case StressRun::Outcome::silent:
      return "WRONG IN SILENCE";
    case StressRun::Outcome::not_started:
      return "not started";
  }
  return "";
}

std::vector<StressRun> runStress(const LocalizationSetup& setup,
                                 const std::function<std::unique_ptr<SampleSource>()>& open,
                                 const std::vector<StampedPose>& reference,
                                 const std::vector<StressFault>& faults) {
  const std::vector<Planned> plan = planOf(faults);
  std::vector<StressRun> runs(plan.size());
  Progress progress("stressing");
  std::mutex progress_mutex;
  std::atomic<std::size_t> done = 0;
  parallelFor(plan.size(), [&](std::size_t i) {
    runs[i] = runOne(setup, open(), plan[i], reference);
    const std::lock_guard lock(progress_mutex);
    progress.update(static_cast<double>(++done) / static_cast<double>(plan.size()));
  });
  return runs;
}

}  // namespace fathom
