#pragma once

#include <filesystem>
#include <vector>

#include "batch/batch_run.h"
#include "report/run_info.h"
#include "report/table.h"

namespace fathom {

/// All that is known of a batch.
struct BatchStory {
  RunInfo run;
  BatchPlan plan;
  std::vector<JobOutcome> outcomes;  ///< one a job

  std::size_t count(JobOutcome::State state) const;
};

/// How far it is: jobs that are done, failed, open, of each run.
Table progressTable(const BatchStory& story);
/// Of each run and column over its jobs that are done: how many, mean, median, largest; of words, how often
/// each.
Table summaryTable(const BatchStory& story);
/// A row a job.
Table jobTable(const BatchStory& story);
/// Of each run: time and memory a job, and what so many recordings would take on so many cores.
Table costTable(const BatchStory& story);

/// batch.csv (a row a job), costs.csv (time and memory, which no two runs have alike), result.json,
/// report.html.
void writeOutputs(const BatchStory& story, const std::filesystem::path& folder);

}  // namespace fathom
