// `fathom compare-fiducials` as people meet it.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "imaging/water.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "support/small_vehicle.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::shellQuoted;

using test::kDexrovMap;
using test::kSource;

const std::string kGrid =
    "families: [DICT_4X4_50, tag16h5]\nranges_m: [1.5, 2.5]\ntilts_deg: [0, 40]\nblurs_px: [0, 1]\n"
    "waters:\n"
    "  - {name: clear, attenuation_per_m: [0.32, 0.07, 0.05], veil: [0.02, 0.14, 0.22], ambient: [0.8, 0.9, "
    "0.9]}\n"
    "  - {name: turbid, attenuation_per_m: [1.1, 0.68, 0.74], veil: [0.05, 0.24, 0.22], ambient: [0.6, 0.8, "
    "0.7]}\n"
    "repeats: 2\n";

/// For what does not depend on how many there are: a quarter of the images.
const std::string kSmallestGrid =
    "families: [DICT_4X4_50]\nranges_m: [1.5, 2.5]\ntilts_deg: [0, 40]\nblurs_px: [0, 1]\n"
    "waters:\n"
    "  - {name: clear, attenuation_per_m: [0.32, 0.07, 0.05], veil: [0.02, 0.14, 0.22], ambient: [0.8, 0.9, "
    "0.9]}\n"
    "repeats: 2\n";

/// On a small grid, with a small camera; run in `folder`, so that the command line is the same elsewhere.
std::string command(const fs::path& folder, const std::string& grid = kGrid) {
  fs::create_directories(folder);
  test::writeNew(folder / "grid.yaml", grid);
  test::writeSmallVehicle(folder);
  return "cd " + shellQuoted(folder.string()) + " && exec " + shellQuoted(test::fathomProgram()) +
         " compare-fiducials --grid grid.yaml --vehicle vehicle.yaml --map " +
         shellQuoted(kDexrovMap.string()) + " --out out";
}

std::vector<std::map<std::string, std::string>> readCsv(const fs::path& file) {
  std::istringstream lines(readTextFile(file));
  const auto split = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream words(line + ",");
    for (std::string field; std::getline(words, field, ',');) fields.push_back(field);
    return fields;
  };
  std::string line;
  std::getline(lines, line);
  const auto header = split(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(lines, line)) {
    const auto fields = split(line);
    EXPECT_EQ(fields.size(), header.size()) << line;
    for (std::size_t i = 0; i < std::min(fields.size(), header.size()); ++i) {
      if (i == 0) rows.emplace_back();
      rows.back()[header[i]] = fields[i];
    }
  }
  return rows;
}

TEST(CompareFiducials, WritesTablesReportAndImages) {
  const auto folder = test::scratchFolder();
  const auto result = test::runShell(command(folder));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("64 images"), std::string::npos) << result.out;
  const auto rows = readCsv(folder / "out/results.csv");
  ASSERT_EQ(rows.size(), 2 * 2 * 2 * 2 * 2 * 2U);  // families, readers, ranges, tilts, waters, blurs
  EXPECT_EQ(readCsv(folder / "out/times.csv").size(), rows.size());
  for (const auto& row : rows) {
    EXPECT_EQ(row.at("images"), "2");
    if (row.at("range_m") != "1.5" || row.at("water") != "clear" || row.at("blur_px") != "0") continue;
    EXPECT_GT(std::stod(row.at("detection_rate")), 0.7) << row.at("family") << " " << row.at("reader");
    EXPECT_LE(std::stod(row.at("detection_rate_low95")), std::stod(row.at("detection_rate")));
    EXPECT_GE(std::stod(row.at("detection_rate_high95")), std::stod(row.at("detection_rate")));
  }
  const auto json = nlohmann::json::parse(readTextFile(folder / "out/result.json"));
  EXPECT_EQ(json.at("comparison").size(), 4U);
  EXPECT_EQ(json.at("run").at("seed"), 1);
  const std::string report = readTextFile(folder / "out/report.html");
  for (const char* part : {"Against range", "Against tilt", "Against turbidity", "Against blur", "<svg"})
    EXPECT_NE(report.find(part), std::string::npos) << part;
  const cv::Mat sheet = cv::imread((folder / "out/contact_sheet.png").string());
  EXPECT_GT(sheet.cols, 5 * 360);  // columns of 360 px
  EXPECT_GT(sheet.rows, 4 * 270);  // rows of families and readers
}

TEST(CompareFiducials, GoesOnAfterBeingKilled) {
  const auto folder = test::scratchFolder();
  ASSERT_EQ(test::runShell(command(folder / "whole", kSmallestGrid)).status, 0);
  const std::string chunks = (folder / "cut/out/chunks").string();
  test::runShell("( " + command(folder / "cut", kSmallestGrid) + " ) & pid=$!; until [[ $(ls " + chunks +
                 "/*.txt 2>/dev/null | wc -l) -ge 3 ]]; do sleep 0.01; done; kill -KILL $pid; wait $pid");
  EXPECT_FALSE(fs::exists(folder / "cut/out/results.csv"));
  ASSERT_TRUE(fs::exists(folder / "cut/out/chunks/inputs.txt"));
  const auto resumed = test::runShell(command(folder / "cut", kSmallestGrid));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  for (const char* file : {"results.csv", "result.json", "contact_sheet.png", "chunks/inputs.txt"})
    EXPECT_TRUE(readTextFile(folder / "whole/out" / file) == readTextFile(folder / "cut/out" / file)) << file;
}

TEST(CompareFiducials, TellsWhatIsWrong) {
  const auto folder = test::scratchFolder();
  const std::string vehicle = " --vehicle " + shellQuoted(test::writeSmallVehicle(folder).string());
  const std::string map = " --map " + shellQuoted(kDexrovMap.string());
  const std::string out = " --out " + shellQuoted((folder / "out").string());
  const auto expectRefused = [&](const std::string& arguments, const std::string& part) {
    test::expectBadInput(runFathom("compare-fiducials " + arguments), part);
    EXPECT_FALSE(fs::exists(folder / "out")) << arguments;
  };
  expectRefused(map + vehicle + out + " --family tag36h12", "tag36h12");
  expectRefused(map + vehicle + out + " --family tagStandard41h12",
                "the aruco backend cannot read tagStandard41h12");
  expectRefused(map + vehicle + out + " --backend artoolkit", "artoolkit not in {aruco,apriltag}");
  expectRefused(map + vehicle + out + " --backend aruco,aruco", "twice");
  expectRefused(map + vehicle + out + " --repeats 0", "--repeats");
  expectRefused(vehicle + out, "--map");
  expectRefused(map + out, "--vehicle");
  expectRefused(map + vehicle, "--out");
  expectRefused(" --map " + (folder / "absent.yaml").string() + vehicle + out, "absent.yaml");
  expectRefused(map + vehicle + out + " --recording a.rawlog", "excludes");
  expectRefused(out + " --recording " + (folder / "absent.rawlog").string(), "absent.rawlog");
  expectRefused(map + vehicle + out + " --calibration " + (folder / "absent.yaml").string(), "absent.yaml");
  expectRefused(" --calibration a.yaml --recording a.rawlog" + out, "excludes");
  test::writeNew(folder / "calibration.yaml", "effects:\n  - {id: fog}\n");
  expectRefused(map + vehicle + out + " --calibration " + (folder / "calibration.yaml").string(),
                "unknown effect `fog`");
  test::writeNew(folder / "grid.yaml", "families: []\n");
  expectRefused(map + vehicle + out + " --grid " + (folder / "grid.yaml").string(),
                "grid.yaml: families (line 1): must have at least one entry");
}

// ---- recordings

/// Six images, two metres before the panel, 320 x 240 px.
fs::path simulatedRecording(const fs::path& folder) {
  SimulationOptions options;
  const fs::path vehicle = test::writeSmallVehicle(folder);
  options.vehicle = readVehicle(vehicle);
  options.duration_s = 5;
  test::writeNew(
      folder / "station.yaml",
      "kind: station\npose: {x: 4.3, y: 0.05, z: -4.25, yaw_deg: 1}\nduration_s: 20\nsway:\n"
      "  - {axis: y, amplitude_m: 0.1, period_s: 7}\n  - {axis: yaw, amplitude_deg: 3, period_s: 8}\n");
  return simulateRecording(options, readTrajectory(folder / "station.yaml"),
                           {folder, "r", vehicle, kDexrovMap, "a test",
                            readEnvironment(kSource / "config/water_moderate.yaml")})
      .rawlog;
}

/// The same images, nothing known of them.
fs::path withoutTruthAndMap(const fs::path& rawlog, const fs::path& folder) {
  RawlogReader reader(rawlog);
  fs::create_directories(folder);
  fs::copy(reader.imageFolder(), folder / "bare_Images", fs::copy_options::recursive);
  std::optional<RawlogWriter> writer;
  while (const auto sample = reader.next()) {
    if (std::holds_alternative<RecordingHeader>(sample->reading)) continue;
    if (!writer) writer.emplace(folder / "bare.rawlog", RecordingHeader{"", "", "bare"}, sample->time);
    if (sample->label == labels::kCamera) writer->write(*sample);
  }
  writer->finish();
  return folder / "bare.rawlog";
}

TEST(CompareFiducials, ReadsARecordingWithAndWithoutTruth) {
  const auto folder = test::scratchFolder();
  const fs::path rawlog = simulatedRecording(folder);
  const fs::path out = folder / "out";
  const auto known = runFathom("compare-fiducials --recording " + shellQuoted(rawlog.string()) + " --out " +
                               shellQuoted(out.string()));
  ASSERT_EQ(known.status, 0) << known.err;
  const auto rows = readCsv(out / "results.csv");
  ASSERT_EQ(rows.size(), 6U);
  std::map<std::string, std::string> detected;
  for (const auto& row : rows) {
    EXPECT_EQ(row.at("images"), "6");
    EXPECT_EQ(row.at("images_with_truth"), "6");
    EXPECT_GT(std::stoi(row.at("markers_visible")), 30);
    EXPECT_GT(std::stod(row.at("detection_rate")), 0.5) << row.at("reader");
    EXPECT_EQ(row.at("not_on_map"), "0");
    EXPECT_LT(std::stod(row.at("corner_rms_px")), 1.0) << row.at("reader");
    EXPECT_LT(std::stod(row.at("position_error_median_m")), 0.02) << row.at("reader");
    detected[row.at("reader")] = row.at("detections");
  }
  const auto pairs = readCsv(out / "agreement.csv");
  ASSERT_EQ(pairs.size(), 15U);
  for (const auto& pair : pairs) {
    EXPECT_EQ(std::stoi(pair.at("both")) + std::stoi(pair.at("only_first")),
              std::stoi(detected.at(pair.at("first"))));
    EXPECT_EQ(std::stoi(pair.at("both")) + std::stoi(pair.at("only_second")),
              std::stoi(detected.at(pair.at("second"))));
  }
  EXPECT_FALSE(cv::imread((out / "contact_sheet.png").string()).empty());

  const fs::path bare = withoutTruthAndMap(rawlog, folder / "bare");
  const std::string arguments = "compare-fiducials --recording " + shellQuoted(bare.string()) + " --out " +
                                shellQuoted((folder / "out_bare").string());
  test::expectBadInput(runFathom(arguments), "--family");
  const auto unknown = runFathom(arguments + " --family DICT_ARUCO_ORIGINAL");
  ASSERT_EQ(unknown.status, 0) << unknown.err;
  for (const auto& row : readCsv(folder / "out_bare/results.csv")) {
    EXPECT_EQ(row.at("detections"), detected.at(row.at("reader")));
    EXPECT_EQ(row.at("images_with_truth"), "0");
    EXPECT_EQ(row.at("detection_rate"), "");
    EXPECT_EQ(row.at("not_on_map"), "");
  }

  // Resumed: nothing is read again, and the bytes are the same; an image that has changed is.
  const std::string before = readTextFile(out / "results.csv"), times = readTextFile(out / "times.csv");
  const std::string again =
      "compare-fiducials --recording " + shellQuoted(rawlog.string()) + " --out " + shellQuoted(out.string());
  ASSERT_EQ(runFathom(again).status, 0);
  EXPECT_EQ(readTextFile(out / "results.csv"), before);
  EXPECT_EQ(readTextFile(out / "times.csv"), times);
  fs::copy_file(folder / "r_Images/CAMERA_0000.png", folder / "r_Images/CAMERA_0003.png",
                fs::copy_options::overwrite_existing);
  ASSERT_EQ(runFathom(again).status, 0);
  EXPECT_NE(readTextFile(out / "results.csv"), before);
  fs::remove(folder / "r_Images/CAMERA_0003.png");
  test::expectBadInput(runFathom(again), "CAMERA_0003.png");
}

}  // namespace
}  // namespace fathom
