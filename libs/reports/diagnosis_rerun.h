#pragma once

#include "reports/diagnosis_story.h"
#include "tasks/recording_localization.h"

namespace fathom {

/// Task TL5 as improved, on the diagnosed recording: everything but the calibration. Throws Error where its
/// configuration cannot be read.
RecordingJob rerunJob(const BatchRecordingOptions& recording, const std::string& command_line);

/// The job without what was found, and with it (calibration.yaml in the story's folder): their files go to
/// the folders localized_before and localized_after in there. Throws Error, Interrupted.
DiagnosisRerun rerunTasks(RecordingJob job, const std::string& known_calibration,
                          const std::filesystem::path& folder);

}  // namespace fathom
