#pragma once

#include <filesystem>
#include <optional>

#include "report/run_info.h"
#include "report/table.h"
#include "tasks/task_outputs.h"
#include "tasks/task_story.h"

namespace fathom {

/// Position errors at fixed times, beside both kinds of dead reckoning; empty without a reference.
Table errorsOverTime(const RecordingStory& recording, const TaskStory& task);
/// One row a channel: fused, gated, mean NIS and its band.
Table channelTable(const LocalizationSummary& summary);

/// Of the recording: run, reference, loss, remarks.
nlohmann::ordered_json toJson(const RecordingStory& recording);
nlohmann::ordered_json toJson(const RecordingStory& recording, const TaskStory& task,
                              const TaskOutputs& outputs);
/// The report of a single task. Throws Error where it cannot be drawn or written.
void writeReport(const std::filesystem::path& file, const RecordingStory& recording, const TaskStory& task,
                 const TaskOutputs& outputs);

}  // namespace fathom
