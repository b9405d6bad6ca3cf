// `fathom evaluate panel`, as people meet it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::scratchFolder;
using test::shellQuoted;

const std::string kPanelMap = test::kDexrovMap.string(), kPanelVehicle = test::kRov.string();
const std::string kClear = (test::kConfig / "water_clear.yaml").string();
const std::string kTurbid = (test::kConfig / "water_turbid.yaml").string();

std::string evaluatePanel(const std::string& map, const std::string& vehicle, const std::string& water) {
  return "evaluate panel --map " + map + " --vehicle " + vehicle + " --water " + water;
}

/// A map, or a vehicle, without what it needs.
std::string without(const std::string& source, const std::string& key, const fs::path& target) {
  std::istringstream lines(readTextFile(source));
  std::string kept;
  bool leaving = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(' ') && !line.starts_with('#')) leaving = line.starts_with(key + ":");
    if (!leaving) kept += line + "\n";
    if (leaving && line == "markers:") kept += "markers: []\n";
  }
  writeTextFile(target, kept);
  return target.string();
}

TEST(EvaluatePanelCommand, WritesAllAndTheSameBytesAgain) {
  const auto folder = scratchFolder();
  const std::string run = "cd " + shellQuoted(folder.string()) + " && ";
  const std::string evaluate = shellQuoted(test::fathomProgram()) + " " +
                               evaluatePanel(kPanelMap, kPanelVehicle, "E0=" + kClear) + " --water " +
                               kTurbid + " --views 4 --seed 5 --out out";
  const auto first = test::runShell(run + evaluate);
  ASSERT_EQ(first.status, 0) << first.err;
  for (const char* part : {"E0", "water_turbid", "mean of markers (paper)", "joint", "mean NEES"})
    EXPECT_NE(first.out.find(part), std::string::npos) << part;
  const std::string csv = readTextFile(folder / "out/views.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 4);
  const auto columns = [&](std::size_t from) {
    const auto end = csv.find('\n', from);
    return std::count(csv.begin() + static_cast<std::ptrdiff_t>(from),
                      csv.begin() + static_cast<std::ptrdiff_t>(end), ',');
  };
  EXPECT_EQ(columns(0), columns(csv.find('\n') + 1));
  const auto json = nlohmann::json::parse(readTextFile(folder / "out/result.json"));
  EXPECT_EQ(json["run"]["seed"], 5);
  ASSERT_EQ(json["waters"].size(), 2U);
  EXPECT_EQ(json["waters"][1]["name"], "water_turbid");
  EXPECT_EQ(json["waters"][0]["all"]["views"], 4);
  EXPECT_LT(json["waters"][0]["all"]["joint"]["position_error_m"]["mean"], 0.01);
  const std::string html = readTextFile(folder / "out/report.html");
  EXPECT_NE(html.find("<svg"), std::string::npos);

  fs::rename(folder / "out", folder / "first");
  const auto second = test::runShell(run + "taskset -c 0 " + evaluate);  // one core
  EXPECT_EQ(second.out, first.out);
  for (const char* file : {"views.csv", "result.json", "report.html"})
    EXPECT_EQ(readTextFile(folder / "first" / file), readTextFile(folder / "out" / file)) << file;
}

TEST(EvaluatePanelCommand, ExpectsTheErrorsOfALensThatIsKnown) {
  const auto folder = scratchFolder();
  const fs::path lens = folder / "lens.yaml";
  writeTextFile(lens, "effects:\n  - {id: focal-scale, scale_error: 0.02, active_s: [10, 20]}\n");
  const auto evaluated = [&](const std::string& more) {
    const auto result =
        runFathom(evaluatePanel(kPanelMap, kPanelVehicle, kClear) + " --views 6 --calibration " +
                  shellQuoted(lens.string()) + more + " --out " + shellQuoted((folder / "out").string()));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("Effects that are on: focal-scale"), std::string::npos) << result.out;
    return nlohmann::json::parse(readTextFile(folder / "out/result.json"));
  };
  const auto error_m = [](const nlohmann::json& json) {
    return json["waters"][0]["all"]["joint"]["position_error_m"]["mean"].get<double>();
  };
  const auto during = evaluated(" --at 15");
  EXPECT_EQ(during["calibration"]["effects"], nlohmann::json({"focal-scale"}));
  EXPECT_EQ(during["calibration"]["fingerprint"].get<std::string>().size(), 16U);
  EXPECT_EQ(during["effects_at_s"], 15);
  EXPECT_GT(error_m(during), 0.015);  // two percent of one to four metres
  EXPECT_LT(error_m(during), 0.085);
  EXPECT_LT(error_m(evaluated("")), 0.005);
}

TEST(EvaluatePanelCommand, RefusesInOneLine) {
  const auto folder = scratchFolder();
  const std::string bare = without(kPanelMap, "markers", folder / "panel.yaml");
  fs::copy(fs::path(kPanelMap).parent_path() / "panel.obj", folder / "panel.obj");
  fs::copy(fs::path(kPanelMap).parent_path() / "panel.mtl", folder / "panel.mtl");
  const std::string blind = without(kPanelVehicle, "camera", folder / "vehicle.yaml");
  const std::string good = evaluatePanel(kPanelMap, kPanelVehicle, kClear);
  test::expectBadInput(runFathom(evaluatePanel(kPanelMap, kPanelVehicle, "/no/such.yaml")), "/no/such.yaml");
  test::expectBadInput(runFathom(evaluatePanel("/no/map.yaml", kPanelVehicle, kClear)), "/no/map.yaml");
  test::expectBadInput(runFathom(evaluatePanel(bare, kPanelVehicle, kClear)), "panel.yaml: markers");
  test::expectBadInput(runFathom(evaluatePanel(kPanelMap, blind, kClear)),
                       "vehicle.yaml: camera: the vehicle has none");
  test::expectBadInput(runFathom(good + " --views 0"), "--views");
  test::expectBadInput(runFathom(good + " --nearest 5"), "--nearest");
  test::expectBadInput(runFathom(good + " --water " + kClear), "there twice");
  test::expectBadInput(runFathom(good + " --water =" + kClear), "the name must");
  test::expectBadInput(runFathom(good + " --at 3"), "--calibration");
  test::expectBadInput(runFathom(good + " --calibration /no/such.yaml"), "/no/such.yaml");
  writeTextFile(folder / "damaged.yaml", "effects:\n  - {id: gamma, exponent_error");
  test::expectBadInput(runFathom(good + " --calibration " + shellQuoted((folder / "damaged.yaml").string())),
                       "damaged.yaml");
  test::expectBadInput(runFathom("evaluate"), "fathom evaluate --help");
  test::expectBadInput(runFathom("evaluate bogus"), "bogus: no such command; there are panel, handles");
  test::expectBadInput(runFathom("evaluate panel --bogus"),
                       "--bogus: no such option; see fathom evaluate panel --help");
}

}  // namespace
}  // namespace fathom
