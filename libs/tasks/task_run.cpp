#include "tasks/task_run.h"

namespace fathom {
namespace {

LocalizationSetup withOptions(LocalizationSetup setup, const TaskSpec& spec) {
  setup.options = spec.options;
  return setup;
}

}  // namespace

TaskRun::TaskRun(const TaskSpec& spec, LocalizationSetup setup, const RecordingStory& recording,
                 const std::filesystem::path& folder, ResultsLog& results, std::size_t stream)
    : spec_(spec),
      recording_(recording),
      outputs_(folder, spec.id(), spec.options.smooth, results, stream),
      evaluator_(recording.reference),
      smooth_evaluator_(recording.reference),
      localizer_(withOptions(std::move(setup), spec), sink()) {
  story_.options = spec.options;
  story_.improved = spec.improved;
}

LocalizationSink TaskRun::sink() {
  LocalizationSink sink;
  sink.estimate = [this](const Estimate& e) {
    outputs_.estimate(e);
    evaluator_.add(e);  // final only after history_s, so TRUTH has come as far
  };
  sink.smoothed = [this](const Estimate& e) {
    outputs_.smoothed(e);
    smooth_evaluator_.add(e);
  };
  sink.innovation = [this](const Innovation& i) { outputs_.innovation(i); };
  sink.event = [this](const Event& e) { outputs_.event(e); };
  return sink;
}

void TaskRun::finish(LocalizationSummary summary) {
  story_.summary = std::move(summary);
  story_.filter = evaluator_.finish();
  story_.smoother = smooth_evaluator_.finish();
  story_.filter_measures = measuresOf(outputs_.poses(), outputs_.poses(), outputs_.lost(), recording_);
  story_.smoother_measures =
      measuresOf(outputs_.smoothedPoses(), outputs_.poses(), outputs_.lost(), recording_);
  outputs_.finish();
}

}  // namespace fathom
