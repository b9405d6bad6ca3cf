#pragma once

#include <filesystem>

#include "evaluation/fiducial_results.h"
#include "inputs/known_effects.h"
#include "report/run_info.h"
#include "report/table.h"

/// What `fathom compare-fiducials` tells of a grid: tables, plots, files.
namespace fathom {

struct FiducialStory {
  RunInfo run;
  std::string map, vehicle;  ///< files
  FiducialGrid grid;
  KnownEffects known;  ///< the grid's effects
  std::vector<FiducialResult> results;
};

/// One row a family and reader: all conditions together, and detection rates water by water.
Table overallTable(const FiducialStory& story);
Table waterTable(const FiducialStory& story);

/// results.csv, times.csv, result.json and report.html. Times are measured: times.csv and report.html have
/// them, the other two are the same each time. Throws Error.
void writeOutputs(const FiducialStory& story, const std::filesystem::path& folder);

}  // namespace fathom
