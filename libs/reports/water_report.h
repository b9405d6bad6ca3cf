#pragma once

#include <filesystem>
#include <string>

#include "environment/water_study.h"
#include "inputs/known_effects.h"
#include "report/run_info.h"
#include "report/table.h"

/// What `fathom fit-water` tells: tables, plots, files.
namespace fathom {

struct WaterStory {
  RunInfo run;
  std::string recording, map, vehicle, default_water;  ///< files
  KnownEffects known{};
  WaterStudy study;
  std::vector<std::string> remarks;
};

/// One row a parameter: fitted with its sigma, default, and truth where it is known.
Table parameterTable(const WaterStory& story);
/// One row a water: FSIM and RMSE on the held-out images.
Table heldOutTable(const WaterStory& story);
/// The panel's pose error that is expected in the recommended water, and the recording's; empty where that is
/// not known.
Table panelPoseTable(const WaterStory& story);

/// NAME_water.yaml, result.json, waters.png and report.html; returns the first. Throws Error.
std::filesystem::path writeOutputs(const WaterStory& story, const std::filesystem::path& folder);

}  // namespace fathom
