#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "report/plot.h"
#include "report/run_info.h"
#include "report/table.h"
#include "tasks/task_outputs.h"
#include "tasks/task_story.h"

namespace fathom {

/// Position errors at fixed times, beside both kinds of dead reckoning; empty without a reference.
Table errorsOverTime(const RecordingStory& recording, const TaskStory& task);
/// One row a channel: fused, gated, mean NIS and its band.
Table channelTable(const LocalizationSummary& summary);

/// A path from above, x and y in odom; a gap where it is lost (of each pose; empty: nowhere).
Series pathSeries(const std::string& name, const std::vector<StampedPose>& poses, Series::Style style,
                  const std::vector<bool>& lost = {});

/// Of the recording: run, reference, loss, remarks.
nlohmann::ordered_json toJson(const RecordingStory& recording);
nlohmann::ordered_json toJson(const RecordingStory& recording, const TaskStory& task,
                              const TaskOutputs& outputs);
/// The report of a single task. Throws Error where it cannot be drawn or written.
void writeReport(const std::filesystem::path& file, const RecordingStory& recording, const TaskStory& task,
                 const TaskOutputs& outputs);

}  // namespace fathom
