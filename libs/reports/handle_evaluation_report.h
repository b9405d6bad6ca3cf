#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/handle_evaluation.h"
#include "report/run_info.h"
#include "report/table.h"

/// What `fathom evaluate handles` tells: tables, plots, files.
namespace fathom {

/// The views of one environment.
struct HandleWaterResults {
  std::string name, file;
  std::vector<HandleViewResult> views;
};

struct HandleEvaluationStory {
  RunInfo run;
  std::string map, vehicle;  ///< files
  HandleEvaluationOptions options;
  std::vector<Handle> handles;  ///< the map's
  std::vector<HandleWaterResults> waters;
};

/// One row a water and method: how far off; of what is stated, whether sigma is honest.
Table handleErrorTable(const HandleEvaluationStory& story);
/// One row a water and kind of handle: the contour's overlap with the renderer's mask.
Table contourTable(const HandleEvaluationStory& story);
/// One row a reason why there is no angle.
Table unreadTable(const HandleEvaluationStory& story);

/// result.json, views.csv (one line a view, `nan` for what is absent) and report.html. Throws Error.
void writeOutputs(const HandleEvaluationStory& story, const std::filesystem::path& folder);

}  // namespace fathom
