#pragma once

#include <filesystem>
#include <optional>

#include "localization_outputs.h"
#include "report/run_info.h"
#include "report/table.h"

namespace fathom {

/// All that a finished localization run has to tell.
struct LocalizationStory {
  RunInfo run;
  std::filesystem::path recording;
  LocalizationOptions options;
  LocalizationSummary summary;
  std::optional<RecordingLoss> loss;
  std::string reference_name;  ///< empty: none
  std::vector<StampedPose> reference;
  std::optional<Evaluation> filter, smoother;
  std::vector<StampedPose> plain, by_reference_attitude;  ///< dead reckoning, see DeadReckoning
  std::vector<std::string> remarks;                       ///< e.g. where vehicle file and recording disagree
};

/// Position errors at fixed times, beside both kinds of dead reckoning; empty without a reference.
Table errorsOverTime(const LocalizationStory& story, Time time_zero);
/// One row a channel: fused, gated, mean NIS and its band.
Table channelTable(const LocalizationSummary& summary);

nlohmann::ordered_json toJson(const LocalizationStory& story, const LocalizationOutputs& outputs,
                              Time time_zero);
/// Throws Error where it cannot be drawn or written.
void writeReport(const std::filesystem::path& file, const LocalizationStory& story,
                 const LocalizationOutputs& outputs, Time time_zero);

}  // namespace fathom
