#pragma once

#include <filesystem>

#include "evaluation/recorded_fiducials.h"
#include "report/run_info.h"
#include "report/table.h"

/// What `fathom compare-fiducials --recording` tells: tables, a plot, files.
namespace fathom {

struct RecordedFiducialsStory {
  RunInfo run;
  std::string recording, map;  ///< files; map empty: unknown
  RecordedFiducialsOptions options;
  std::vector<RecordedResult> results;
  std::optional<RecordingLoss> loss;
};

/// One row a reader, and one a pair of readers.
Table readerTable(const RecordedFiducialsStory& story);
Table agreementTable(const RecordedFiducialsStory& story);

/// results.csv, agreement.csv, times.csv, result.json and report.html. Times are measured: times.csv and
/// report.html have them, the others are the same each time. Throws Error.
void writeOutputs(const RecordedFiducialsStory& story, const std::filesystem::path& folder);

}  // namespace fathom
