#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "report/table.h"
#include "tasks/recording_localization.h"

namespace fathom {

/// The paper's table: a row for each estimate of each task (filter, and smoother where it ran), errors over
/// the marker sightings as mean ± sigma against the markers' pose M and, where there is one, the reference S;
/// m_A; the share of errors inside 3 sigma.
Table taskTable(const LocalizedRecording& recording);

/// All of a recording's tasks. Throws Error where it cannot be drawn or written.
void writeTasksReport(const std::filesystem::path& file, const LocalizedRecording& recording);
nlohmann::ordered_json toJson(const LocalizedRecording& recording);

}  // namespace fathom
