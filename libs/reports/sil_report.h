#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/run_info.h"
#include "report/table.h"
#include "sil/sil_run.h"

/// What `fathom sil` tells: tables, plots, files.
namespace fathom {

struct SilStory {
  RunInfo run;
  std::string recording, map, vehicle, water, calibration;  ///< files; the last one may be empty
  std::optional<KnownSeaFloor> sea_floor;
  SilOptions options;
  SilResults results;
  std::vector<std::string> remarks;
  cv::Mat sheet;  ///< see silSheet
};

/// One row a quantity: over how many pairs, mean, sigma, median, extremes.
Table measureTable(const SilStory& story);
/// One row a reason why images are not paired.
Table unpairedTable(const SilStory& story);

/// measures.csv, unpaired.csv, contact_sheet.png, result.json and report.html. Throws Error.
void writeOutputs(const SilStory& story, const std::filesystem::path& folder);

}  // namespace fathom
