#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "batch/batch_plan.h"
#include "batch/share.h"

namespace fathom {

/// What became of a job.
struct JobOutcome {
  enum class State { open, failed, done };
  State state = State::open;
  std::string complaint;  ///< of a failed one: what its program said last
  double wall_s = 0, cpu_s = 0, peak_mb = 0;
  nlohmann::ordered_json result;  ///< of one that is done: its result.json
};

struct BatchRunOptions {
  std::filesystem::path program;  ///< fathom itself
  std::filesystem::path folder;   ///< OUT; a job's own is OUT/jobs/NAME
  std::size_t at_once = 0;        ///< jobs; 0: as many as there are cores
  Share share;
};

std::filesystem::path folderOf(const BatchJob& job, const std::filesystem::path& folder);

/// What is on disk: open where it was never run to its end, or with another command, program or recording.
JobOutcome outcomeOf(const BatchJob& job, const std::filesystem::path& folder);

/// Runs all jobs of the share that are not done, each as a process of its own, on one core where several run
/// at once. A job counts as done by one small file that is written last, when the rest is whole; what a
/// killed one has left is removed before it begins anew. Two programs at one folder share the work: a job
/// that another one holds (flock) is left to it. A job that fails stops no other. Throws Interrupted.
void runJobs(const BatchPlan& plan, const BatchRunOptions& options);

}  // namespace fathom
