#pragma once

#include "report/html_report.h"
#include "reports/diagnosis_plots.h"
#include "reports/diagnosis_story.h"

/// A diagnosis's report on where model and recording differ.
namespace fathom {

/// The mismatches as a map, covariates against sensors, and the most improbable one by one; again with what
/// was found in the model.
void addMismatch(const DiagnosisStory& story, HtmlReport& report);

/// Residuals against the covariates that tell most, and over time: of the nominal model and of the final one.
void addResiduals(const DiagnosisStory& story, const BeforeAndAfter& residuals, HtmlReport& report);

}  // namespace fathom
