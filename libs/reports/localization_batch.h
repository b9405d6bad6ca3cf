#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "report/run_info.h"
#include "report/table.h"
#include "tasks/recording_localization.h"

namespace fathom {

/// What became of one recording of a batch.
struct BatchEntry {
  std::filesystem::path recording, folder;
  std::string failure;  ///< one line; empty: done
  bool done_before = false;
  nlohmann::ordered_json result;  ///< its result.json
};

/// Runs one recording's job and writes its report and result.json. Throws Error, Interrupted.
LocalizedRecording localizeAndReport(const RecordingJob& job);
/// The same; where an earlier run has done the same job
/// with the same inputs, only takes its result. Throws Error, Interrupted.
BatchEntry runJob(const RecordingJob& job);

/// Runs all jobs, one after the other, each on all cores. A recording that cannot be localized is an entry
/// with its failure, and does not stop the rest. `done` hears of each one. Throws Interrupted.
std::vector<BatchEntry> runBatch(const std::vector<RecordingJob>& jobs,
                                 const std::function<void(const BatchEntry&)>& done);

/// A row for each task over all recordings that were done: how many, mean, median and largest of their mean
/// errors against S and against M, and how many ended lost.
Table batchTable(const std::vector<BatchEntry>& entries);
/// report.html and summary.json in the folder.
void writeBatchReport(const std::filesystem::path& folder, const std::vector<BatchEntry>& entries,
                      const RunInfo& run);

}  // namespace fathom
