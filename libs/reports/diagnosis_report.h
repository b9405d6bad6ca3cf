#pragma once

#include "reports/diagnosis_story.h"

namespace fathom {

/// Writes result.json, calibration.yaml, trajectory.tum (of the final model) and report.html into the story's
/// folder. Throws Error.
void writeDiagnosis(const DiagnosisStory& story);

}  // namespace fathom
