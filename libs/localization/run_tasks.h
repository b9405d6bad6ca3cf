#pragma once

#include <functional>
#include <vector>

#include "localization/localizer.h"
#include "recording/sample_source.h"

namespace fathom {

/// What may be done while tasks run. Called from the calling thread only.
struct TaskHooks {
  /// Every sample, before any task gets it.
  std::function<void(const Sample&)> sample = [](const Sample&) {};
  /// Between two blocks of samples; all tasks have got all samples up to this time since the first entry. May
  /// throw Interrupted.
  std::function<void(double newest_t_s)> block = [](double) {};
};

/// Runs several localizers over one source, which is read once, all cores at once: while they work on one
/// block of samples the next is read. Memory does not depend on the source's length. Returns their summaries.
std::vector<LocalizationSummary> runTasks(SampleSource& source, const std::vector<Localizer*>& tasks,
                                          Time time_zero, const TaskHooks& hooks = {});

}  // namespace fathom
