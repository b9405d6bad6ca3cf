#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/panel_evaluation.h"
#include "inputs/known_effects.h"
#include "report/run_info.h"
#include "report/table.h"

/// What `fathom evaluate panel` tells: tables, plots, files.
namespace fathom {

/// The views of one environment.
struct WaterResults {
  std::string name, file;
  std::vector<PanelViewResult> views;
};

struct PanelEvaluationStory {
  RunInfo run;
  std::string map, vehicle;  ///< files
  PanelEvaluationOptions options;
  KnownEffects known;  ///< the options' effects
  std::vector<WaterResults> waters;
};

/// One row an environment and method: errors, their ratio, what failed; whether uncertainties are honest.
Table errorTable(const PanelEvaluationStory& story);
Table honestyTable(const PanelEvaluationStory& story);

/// result.json, views.csv (one line a view, `nan` for what is absent) and report.html. Throws Error.
void writeOutputs(const PanelEvaluationStory& story, const std::filesystem::path& folder);

}  // namespace fathom
