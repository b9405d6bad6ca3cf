// `fathom fit-water` as its user runs it: the water it writes goes into `fathom simulate`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/water_recordings.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

test::ProgramResult fitWaterOf(const RecordingFiles& recording, const fs::path& out,
                               const fs::path& water = test::kConfig / "water_clear.yaml",
                               const fs::path& calibration = {}) {
  const std::string known =
      calibration.empty() ? "" : " --calibration " + test::shellQuoted(calibration.string());
  return test::runFathom("fit-water " + test::shellQuoted(recording.rawlog.string()) + " --water " +
                         test::shellQuoted(water.string()) + known +
                         " --search-steps 6 --images 12 --held-out 4 --out " +
                         test::shellQuoted(out.string()));
}

TEST(FitWaterCommand, WritesAWaterThatSimulateTakes) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateApproach(folder, "water_moderate.yaml");
  const fs::path out = folder / "out";
  const auto result = fitWaterOf(recording, out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto json = nlohmann::json::parse(readTextFile(out / "result.json"));
  EXPECT_EQ(json.at("recommended"), "fitted");
  EXPECT_NEAR(json.at("fit").at("environment").at("attenuation_per_m").at(1).get<double>(), 0.20, 0.004);
  EXPECT_TRUE(json.at("panel_pose_errors").at(0).contains("agree"));
  EXPECT_NE(readTextFile(out / "report.html").find("data:image/png;base64,"), std::string::npos);
  EXPECT_FALSE(cv::imread((out / "waters.png").string()).empty());
  const fs::path water = out / "r_water.yaml";
  EXPECT_NEAR(readEnvironment(water).water.veil[2], 0.20, 0.004);

  const auto simulated = test::runFathom(
      "simulate --trajectory " + test::shellQuoted((folder / "trajectory.yaml").string()) + " --vehicle " +
      test::shellQuoted(test::kRov.string()) + " --map " + test::shellQuoted(test::kDexrovMap.string()) +
      " --duration 1 --water " + test::shellQuoted(water.string()) + " --out " +
      test::shellQuoted((folder / "again").string()));
  EXPECT_EQ(simulated.status, 0) << simulated.err;

  // The same command, the same bytes.
  const std::string before = readTextFile(out / "result.json");
  ASSERT_EQ(fitWaterOf(recording, out).status, 0);
  EXPECT_EQ(readTextFile(out / "result.json"), before);
  EXPECT_FALSE(json.contains("calibration"));

  // Told of a lens that is darker in the corners, which it was not: another water.
  const fs::path lens = folder / "lens.yaml";
  writeTextFile(lens, "effects:\n  - {id: vignetting, corner_loss: 0.3}\n");
  const auto told = fitWaterOf(recording, folder / "told", test::kConfig / "water_clear.yaml", lens);
  ASSERT_EQ(told.status, 0) << told.err;
  const auto with = nlohmann::json::parse(readTextFile(folder / "told/result.json"));
  EXPECT_EQ(with.at("calibration").at("file"), lens.string());
  EXPECT_EQ(with.at("calibration").at("effects"), nlohmann::json({"vignetting"}));
  EXPECT_NE(with.at("fit").at("environment"), json.at("fit").at("environment"));
  EXPECT_NE(readTextFile(folder / "told/r_water.yaml").find("beside the effects of"), std::string::npos);
  EXPECT_NE(readTextFile(folder / "told/report.html").find("Effects that are on: vignetting"),
            std::string::npos);
}

TEST(FitWaterCommand, WhatCannotBeFittedIsOneLine) {
  const auto folder = test::scratchFolder();
  const auto away = test::simulateForSil(folder, {.images = 2, .yaw_deg = 180});
  test::expectBadInput(
      fitWaterOf(away, folder / "out"),
      "in none of its 2 images markers tell where it was taken; the first: no marker of a panel");
  fs::create_directories(folder / "near");
  const auto near = test::simulateForSil(folder / "near", {.images = 2});
  test::expectBadInput(fitWaterOf(near, folder / "out"), "only ");
  const fs::path clear = test::kConfig / "water_clear.yaml", damaged = folder / "damaged.yaml";
  test::expectBadInput(fitWaterOf(near, folder / "out", clear, folder / "absent.yaml"), "absent.yaml");
  writeTextFile(damaged, "effects: [{id: gamma}]\n");
  test::expectBadInput(fitWaterOf(near, folder / "out", clear, damaged), "exponent_error");
  const fs::path lamps = folder / "lamps.yaml";
  writeTextFile(lamps, readTextFile(test::kSilWater) + "lamps_irradiance_1m: [1, 1, 1]\n");
  test::expectBadInput(fitWaterOf(near, folder / "out", lamps), "water is fitted in daylight only");
  for (int i = 0; i < 2; ++i) {
    const fs::path image = near.images / ("CAMERA_000" + std::to_string(i) + ".png");
    cv::imwrite(image.string(), cv::Mat(100, 100, CV_8UC3, cv::Scalar(9, 9, 9)));
  }
  test::expectBadInput(fitWaterOf(near, folder / "out"), "is of 100 x 100 pixels, its camera of 320 x 240");
  EXPECT_FALSE(fs::exists(folder / "out/report.html"));
}

}  // namespace
}  // namespace fathom
