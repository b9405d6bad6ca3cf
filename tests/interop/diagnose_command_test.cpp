// `fathom diagnose` as its user meets it, on a recording that the program has simulated.
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "support/run_program.h"
#include "support/sanitized.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "support/small_vehicle.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

/// Configuration is looked up from the project's folder.
test::ProgramResult runAtHome(const std::string& arguments) {
  return test::runShell("cd " + test::shellQuoted(test::kSource.string()) + " && " +
                        test::shellQuoted(test::fathomProgram()) + " " + arguments);
}

constexpr double kScaleError = 0.05;
const std::string kQuickly = "--max-effects 1";

/// A quarter of a minute before the panel, with a DVL that reads too much.
class DiagnoseCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // A folder for each process: ctest's shards run side by side.
    folder_ = fs::temp_directory_path() / "fathom-tests" / ("diagnose-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    writeTextFile(folder_ / "truth.yaml",
                  "effects:\n  - {id: dvl-scale, scale_error: " + std::to_string(kScaleError) + "}\n");
    const auto done = runAtHome("simulate --trajectory config/trajectory_survey.yaml --vehicle " +
                                test::writeSmallVehicle(folder_).string() +
                                " --map maps/dexrov/panel.yaml --water config/water_clear.yaml "
                                "--image-format jpg --begin 4 --duration 16 --seed 5 --name dive "
                                "--calibration " +
                                (folder_ / "truth.yaml").string() + " --out " + (folder_ / "rec").string());
    ASSERT_EQ(done.status, 0) << done.err;
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static test::ProgramResult diagnose(const std::string& what) {
    return runAtHome("diagnose " + (folder_ / "rec/dive.rawlog").string() + " " + what);
  }

  inline static fs::path folder_;
};

TEST_F(DiagnoseCommand, NamesWhatIsMissingAndWritesItAsACalibration) {
  const fs::path out = test::scratchFolder() / "out";
  // On the very recording, for want of another: what is judged is in tests/recovery.
  const std::string judged = " --judge " + (folder_ / "rec/dive.rawlog").string();
  const auto first = diagnose(kQuickly + judged + " --rerun --out " + out.string());
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(first.err, "");
  for (const char* part : {"explained: ", "dvl-scale", "scale_error", "Held out",
                           "fathom simulate --trajectory", "report.html", "as found", "On other recordings"})
    EXPECT_NE(first.out.find(part), std::string::npos) << part << "\n" << first.out;

  const std::string bytes = readTextFile(out / "result.json");
  const auto elsewhere = nlohmann::json::parse(bytes)["elsewhere"];
  ASSERT_EQ(elsewhere.size(), 1U);
  EXPECT_LT(elsewhere[0]["metrics"][0]["after"], elsewhere[0]["metrics"][0]["before"]);
  const auto json = nlohmann::json::parse(bytes)["diagnosis"];
  EXPECT_EQ(json["verdict"], "explained") << json["why"];
  ASSERT_GE(json["effects"].size(), 1U);
  const auto& effect = json["effects"][0];
  EXPECT_EQ(effect["id"], "dvl-scale");
  const double found = effect["parameters"]["scale_error"], sigma = effect["sigma"]["scale_error"];
  EXPECT_NEAR(found, kScaleError, 4 * sigma);
  EXPECT_FALSE(json["mismatch"].empty());

  const auto calibration = readCalibration(out / "calibration.yaml");
  EXPECT_EQ(*calibration.of<DvlScale>(), found);

  const std::string report = readTextFile(out / "report.html");
  if (test::kSanitized) return;  // one diagnosis takes minutes there
  const auto again = diagnose(kQuickly + judged + " --rerun --out " + out.string());
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(readTextFile(out / "result.json"), bytes);
  EXPECT_EQ(readTextFile(out / "report.html"), report);
}

TEST_F(DiagnoseCommand, WhatIsKnownIsNotFoundAgain) {
  if (test::kSanitized) GTEST_SKIP() << "one diagnosis is enough under sanitizers";
  const fs::path out = test::scratchFolder() / "out";
  const auto done =
      diagnose(kQuickly + " --calibration " + (folder_ / "truth.yaml").string() + " --out " + out.string());
  ASSERT_EQ(done.status, 0) << done.err;
  const auto json = nlohmann::json::parse(readTextFile(out / "result.json"))["diagnosis"];
  for (const auto& effect : json["effects"]) EXPECT_NE(effect["id"], "dvl-scale");
}

TEST_F(DiagnoseCommand, HelpTellsTheVerdictsAndExamples) {
  const auto help = test::runFathom("diagnose --help");
  EXPECT_EQ(help.status, 0);
  for (const char* part : {"none", "explained", "unexplained", "insufficient", "--false-alarm", "--rerun",
                           "Examples:", "calibration.yaml"})
    EXPECT_NE(help.out.find(part), std::string::npos) << part;
}

TEST_F(DiagnoseCommand, WrongInputIsOneLine) {
  const std::string out = " --out " + (test::scratchFolder() / "out").string();
  test::expectBadInput(test::runFathom("diagnose nowhere.rawlog" + out), "nowhere.rawlog");
  test::expectBadInput(diagnose("--vehicle nowhere.yaml" + out), "nowhere.yaml");
  test::expectBadInput(diagnose("--calibration nowhere.yaml" + out), "nowhere.yaml");
  test::expectBadInput(diagnose("--judge nowhere.rawlog" + out), "nowhere.rawlog");
  test::expectBadInput(diagnose("--false-alarm 2" + out), "--false-alarm");
  test::expectBadInput(diagnose("--start here" + out), "--start");
  test::expectBadInput(test::runFathom("diagnose " + out), "RECORDING");
  writeTextFile(folder_ / "bad.yaml", "effects:\n  - {id: dvl-scales, scale_error: 0.1}\n");
  test::expectBadInput(diagnose("--calibration " + (folder_ / "bad.yaml").string() + out), "dvl-scales");
}

// What ships with its answer sealed, and the quickstart diagnoses: a navigation effect and one of light.
TEST(SealedRecording, IsReadByDiagnosis) {
  if (test::kSanitized) GTEST_SKIP() << "takes minutes under sanitizers";
  const fs::path folder = test::scratchFolder(), out = folder / "out";
  fs::copy(test::kSource / "rawlogs/sealed", folder / "sealed", fs::copy_options::recursive);
  const auto done =
      runAtHome("diagnose " + (folder / "sealed/sealed.rawlog").string() + " --out " + out.string());
  ASSERT_EQ(done.status, 0) << done.err;
  const auto json = nlohmann::json::parse(readTextFile(out / "result.json"))["diagnosis"];
  EXPECT_EQ(json["verdict"], "explained") << json["why"];
  const auto answer = readCalibration(test::kSource / "rawlogs/sealed_answer.yaml");
  const auto found = readCalibration(out / "calibration.yaml");
  EXPECT_EQ(found.on, answer.on) << json["why"];
  for (const auto& effect : json["effects"])
    for (const auto& [name, sigma] : effect["sigma"].items()) {
      const auto* info = findEffect(effect["id"].get<std::string>());
      ASSERT_NE(info, nullptr);
      const auto values = sigma.is_array() ? sigma : nlohmann::json::array({sigma});
      for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(found.values[info->first_scalar + i], answer.values[info->first_scalar + i],
                    4 * values[i].get<double>())
            << info->id << " " << name << " " << i;
    }
  const std::string report = readTextFile(out / "report.html");
  EXPECT_NE(report.find("Recorded and simulated"), std::string::npos);
  EXPECT_NE(report.find("class=\"slider\""), std::string::npos);
  // Desktop and phone: nothing to say on the page's console, and nothing wider than the window.
  const fs::path script = test::kSource / "tests/interop/open-report";
  for (const std::string width : {"1280", "400"}) {
    const auto opened = test::runShell(test::shellQuoted(script.string()) + " " +
                                       test::shellQuoted((out / "report.html").string()) + " " + width);
    EXPECT_EQ(opened.status, 0) << width << " px: " << opened.err;
  }
}

}  // namespace
}  // namespace fathom
