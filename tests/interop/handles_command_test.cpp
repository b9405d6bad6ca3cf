// `fathom handles` and `fathom evaluate handles`, as people meet them.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::scratchFolder;
using test::shellQuoted;

const std::string kTrial = std::string(FATHOM_SOURCE_DIR) + "/rawlogs/trial/trial.rawlog";
const std::string kWater = std::string(FATHOM_SOURCE_DIR) + "/config/water_turbid.yaml";
const std::string kMap = std::string(FATHOM_SOURCE_DIR) + "/maps/dexrov/panel.yaml";

TEST(HandlesCommand, ReadsTheTrialsHandles) {
  const fs::path out = scratchFolder() / "out";
  const auto result = runFathom("handles " + kTrial + " --water " + kWater + " --every 60 --truth " + kMap +
                                " --out " + shellQuoted(out.string()));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(readTextFile(out / "result.json"));
  const PanelMap truth = readPanelMap(kMap), read = readPanelMap(out / "panel/panel.yaml");
  std::size_t confident = 0;
  for (const auto& handle : json["handles"]) {
    if (handle["confident"] == 0) continue;
    ++confident;
    for (std::size_t i = 0; i < truth.handles.size(); ++i)
      if (truth.handles[i].id == handle["id"]) {
        EXPECT_NEAR(handle["angle_deg"].get<double>(), degrees(truth.handles[i].angle_rad), 3)
            << handle["id"];
        EXPECT_NEAR(degrees(read.handles[i].angle_rad), handle["angle_deg"].get<double>(), 1e-6);
      }
  }
  EXPECT_GE(confident, 7U);
  RawlogReader rawlog(out / "trial_results.rawlog");
  EXPECT_EQ(rawlog.header().panel_map, "panel/panel.yaml");
  std::size_t panels = 0, handles = 0;
  while (const auto sample = rawlog.next()) {
    panels += sample->label == labels::kPanel ? 1 : 0;
    handles += sample->label == labels::kHandles ? 1 : 0;
  }
  EXPECT_EQ(panels, json["images"].get<std::size_t>());
  EXPECT_GT(handles, 0U);
  EXPECT_FALSE(fs::is_empty(out / "evidence"));
}

TEST(HandlesCommand, ReadsBothImagesOfAPair) {
  const std::string root = FATHOM_SOURCE_DIR;
  const fs::path folder = scratchFolder();
  std::string vehicle = readTextFile(root + "/config/rov.yaml");
  vehicle.insert(vehicle.find("camera:\n") + 8,
                 "  right_pose: {x: 0.12, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}\n");
  writeTextFile(folder / "rov.yaml", vehicle);
  const std::string water = root + "/config/water_moderate.yaml";
  const auto made =
      runFathom("simulate --trajectory " + root + "/config/trajectory_station.yaml --duration 2 --name pair" +
                " --vehicle " + shellQuoted((folder / "rov.yaml").string()) + " --map " + kMap + " --water " +
                water + " --out " + shellQuoted(folder.string()));
  ASSERT_EQ(made.status, 0) << made.err;
  const auto read =
      runFathom("handles " + shellQuoted((folder / "pair.rawlog").string()) + " --water " + water +
                " --no-simulation --no-pictures --out " + shellQuoted((folder / "out").string()));
  ASSERT_EQ(read.status, 0) << read.err;
  std::map<std::string, double> angles;  // by image and handle
  std::istringstream csv(readTextFile(folder / "out/handles.csv"));
  for (std::string line; std::getline(csv, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells[5] == "1") angles[cells[2] + " " + cells[4]] = std::stod(cells[6]);
  }
  std::size_t pairs = 0;
  for (const auto& [of, left] : angles)
    if (const auto eye = of.find("_left"); eye != std::string::npos)
      if (const auto right = angles.find(std::string(of).replace(eye, 5, "_right")); right != angles.end()) {
        ++pairs;
        EXPECT_NEAR(right->second, left, 5) << of;  // five sigmas of their difference
      }
  EXPECT_GE(pairs, 9U);
}

TEST(HandlesCommand, RefusesInOneLine) {
  const std::string out = " --out " + shellQuoted((scratchFolder() / "out").string());
  test::expectBadInput(runFathom("handles /no/such.rawlog --water " + kWater + out), "/no/such.rawlog");
  test::expectBadInput(runFathom("handles " + kTrial + " --water " + kWater + " --every 100000" + out),
                       "no image shows");
  test::expectBadInput(runFathom("evaluate handles --map " + kMap + " --vehicle /no/such.yaml"),
                       "/no/such.yaml");
}

TEST(EvaluateHandles, SameSeedSameBytes) {
  const fs::path folder = scratchFolder();
  const auto run = [&](const char* name) {
    const auto result =
        runFathom("evaluate handles --views 6 --map " + kMap + " --vehicle " + FATHOM_SOURCE_DIR +
                  "/config/rov.yaml --water moderate=" + FATHOM_SOURCE_DIR +
                  "/config/water_moderate.yaml --out " + shellQuoted((folder / name).string()));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("paper's chain"), std::string::npos);
    return readTextFile(folder / name / "views.csv");
  };
  EXPECT_EQ(run("a"), run("b"));
}

}  // namespace
}  // namespace fathom
