#pragma once

#include <filesystem>
#include <string>

#include "localization/localizer.h"
#include "tasks/task_outputs.h"
#include "tasks/task_spec.h"
#include "tasks/task_story.h"

namespace fathom {

/// One task on one recording: its filter, the files it writes, and what the reports need.
class TaskRun {
 public:
  /// `setup` lacks the options, which the spec has. `recording` grows while the task runs.
  TaskRun(const TaskSpec& spec, LocalizationSetup setup, const RecordingStory& recording,
          const std::filesystem::path& folder, ResultsLog& results, std::size_t stream);

  Localizer& localizer() { return localizer_; }
  const TaskSpec& spec() const { return spec_; }
  /// When all samples have been seen. Throws Error where a file cannot be written.
  void finish(LocalizationSummary summary);

  const TaskStory& story() const { return story_; }
  const TaskOutputs& outputs() const { return outputs_; }

 private:
  LocalizationSink sink();

  TaskSpec spec_;
  const RecordingStory& recording_;
  TaskOutputs outputs_;
  Evaluator evaluator_, smooth_evaluator_;
  TaskStory story_;
  Localizer localizer_;
};

}  // namespace fathom
