// Every file in config/ is read by whoever it is for: no shipped example may be stale.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>

#include "batch/batch_plan.h"
#include "diagnosis/budget_file.h"
#include "effects/calibration.h"
#include "evaluation/fiducial_grid.h"
#include "imaging/water.h"
#include "localization/options.h"
#include "ros_bag/topic_map.h"
#include "sensors/vehicle.h"
#include "simulation/read_trajectory.h"
#include "sources/make_source.h"
#include "sources/stress.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using test::kConfig;
const fs::path kDive = test::kSource / "rawlogs/dive/dive.rawlog";

/// By the end of the file's name.
const auto kLocalization = [](const fs::path& file) { readLocalizationOptions(file); };
const std::map<std::string, std::function<void(const fs::path&)>> kReaders{
    {"rov.yaml", [](const fs::path& file) { readVehicle(file); }},
    {"_trajectory.yaml", [](const fs::path& file) { readTrajectory(file); }},
    {"trajectory_station.yaml", [](const fs::path& file) { readTrajectory(file); }},
    {"trajectory_survey.yaml", [](const fs::path& file) { readTrajectory(file); }},
    {"trajectory_recorded.yaml", [](const fs::path& file) { readTrajectory(file); }},
    {"water_clear.yaml", [](const fs::path& file) { readEnvironment(file); }},
    {"water_moderate.yaml", [](const fs::path& file) { readEnvironment(file); }},
    {"water_turbid.yaml", [](const fs::path& file) { readEnvironment(file); }},
    {"TL1.yaml", kLocalization},
    {"TL2.yaml", kLocalization},
    {"TL3.yaml", kLocalization},
    {"TL4.yaml", kLocalization},
    {"TL5.yaml", kLocalization},
    {"improved.yaml", kLocalization},
    {"defaults.yaml", kLocalization},
    {"navigation.yaml", kLocalization},
    {"sea_trial.yaml", kLocalization},
    {"sea_trial_earth.yaml", [](const fs::path& file) { readCalibration(file); }},
    {"error_budget.yaml", [](const fs::path& file) { readErrorBudget(file); }},
    {"laboratory_budget.yaml", [](const fs::path& file) { readErrorBudget(file); }},
    {"husky.yaml", kLocalization},
    {"degrade_bottom_lock.yaml", [](const fs::path& file) { readDegradation(file); }},
    {"degrade_dvl_outage.yaml", [](const fs::path& file) { readDegradation(file); }},
    {"degrade_landmarks.yaml", [](const fs::path& file) { readDegradation(file); }},
    {"degrade_poor_bus.yaml", [](const fs::path& file) { readDegradation(file); }},
    {"stress.yaml", [](const fs::path& file) { readStress(file); }},
    {"sources_simulated_dvl.yaml", [](const fs::path& file) { makeSource(file, kDive); }},
    {"batch.yaml",
     [](const fs::path& file) {  // its recordings are as typed in the source folder
       const fs::path before = fs::current_path();
       fs::current_path(test::kSource);
       readBatchPlan(file);
       fs::current_path(before);
     }},
    {"compare_fiducials.yaml", [](const fs::path& file) { readFiducialGrid(file); }},
    {"_topics.yaml", [](const fs::path& file) { readTopicMap(file); }},
};

TEST(ShippedConfig, EveryYamlFileIsReadByItsReader) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kConfig)) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    const std::string name = entry.path().filename().string();
    bool known = false;
    for (const auto& [ending, read] : kReaders) {
      if (!name.ends_with(ending)) continue;
      known = true;
      EXPECT_NO_THROW(read(entry.path())) << name;
    }
    EXPECT_TRUE(known) << name << ": who reads it? Add its reader here";
  }
  EXPECT_GE(files, 3);
}

}  // namespace
}  // namespace fathom
