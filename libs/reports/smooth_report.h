#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "estimation/batch_estimate.h"
#include "estimation/linearization.h"
#include "report/run_info.h"

namespace fathom {

/// A batch estimate, done, and what it was made from.
struct SmoothedRecording {
  RunInfo run;
  std::filesystem::path recording;
  BatchInput input;
  BatchEstimate estimate;
  std::array<double, kChannelCount> noise_scale{};  ///< as taken, by Channel
  Linearization linear;                             ///< without effect columns
  std::vector<std::string> remarks;
};

/// Writes result.json and report.html into the folder. Throws Error.
void writeSmoothReport(const SmoothedRecording& recording, const std::filesystem::path& folder);

}  // namespace fathom
