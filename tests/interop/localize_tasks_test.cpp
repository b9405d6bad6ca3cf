// `fathom localize --tasks` and `fathom stress` as one types them, on a simulated recording with images.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <set>

#include "support/run_program.h"
#include "support/sanitized.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "tasks/stress_runs.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kFiveTasks = " --tasks TL1,TL2,TL3,TL4,TL5 --start reference";

/// Names of tasks, and --improved, are looked up from the project's folder.
test::ProgramResult fathomAtHome(const std::string& arguments) {
  return test::runShell("cd " + test::shellQuoted(test::kSource.string()) + " && " +
                        test::shellQuoted(test::fathomProgram()) + " " + arguments);
}

Json jsonOf(const fs::path& file) { return Json::parse(readTextFile(file)); }

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::vector<fs::path> detectionsBeside(const fs::path& recording) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(recording.parent_path()))
    if (entry.path().filename().string().starts_with(recording.stem().string() + "_detections_"))
      files.push_back(entry.path());
  return files;
}

/// Twenty seconds before the panel, simulated once.
class LocalizeTasks : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // A folder for each process: ctest's shards run side by side.
    folder_ = fs::temp_directory_path() / "fathom-tests" / ("localize_tasks-" + std::to_string(getpid()));
    simulate(folder_ / "rec", "dive",
             "--map maps/dexrov/panel.yaml --water config/water_clear.yaml --image-format jpg");
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static void simulate(const fs::path& folder, const std::string& name, const std::string& more) {
    const auto done = fathomAtHome(
        "simulate --trajectory config/trajectory_station.yaml --vehicle config/trial_rov.yaml --duration 20 "
        "--name " +
        name + " --out " + test::shellQuoted(folder.string()) + " " + more);
    ASSERT_EQ(done.status, 0) << done.err;
  }

  static test::ProgramResult localize(const std::string& what, const fs::path& out) {
    return fathomAtHome("localize " + what + " --out " + test::shellQuoted(out.string()));
  }

  static std::string recording() { return test::shellQuoted((folder_ / "rec/dive.rawlog").string()); }

  inline static fs::path folder_;
};

TEST_F(LocalizeTasks, ComparesTheTasksSideBySide) {
  const fs::path out = test::scratchFolder() / "out";
  const auto first = localize(recording() + kFiveTasks, out);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(first.err, "");
  EXPECT_NE(first.out.find("41 images, markers seen in 41"), std::string::npos) << first.out;
  for (const char* row :
       {"\nTL1  ", "\nTL2  ", "\nTL3  ", "\nTL4  ", "\nTL5  ", "\nTL5 improved, smoothed  "})
    EXPECT_EQ(countOf(first.out, row), 1U) << row << first.out;

  const std::string bytes = readTextFile(out / "result.json");
  const Json result = Json::parse(bytes);
  EXPECT_EQ(result["tasks"].size(), 10U);
  for (const std::string name : {"TL1", "TL2", "TL3", "TL4", "TL5"})
    for (const std::string& id : {name, name + "_IMPROVED"}) {
      ASSERT_TRUE(result["tasks"].contains(id)) << id;
      const Json& task = result["tasks"][id];
      EXPECT_EQ(task["filter_measures"]["against_reference"]["sightings"], 41) << id;
      EXPECT_EQ(task["filter_measures"]["against_markers"]["sightings"], 41) << id;
      EXPECT_EQ(task.contains("smoother_measures"), task["improved"].get<bool>()) << id;
      EXPECT_EQ(task["channels"].contains("landmark"), name != "TL2") << id;
      EXPECT_TRUE(fs::exists(out / id / "trajectory.tum")) << id;
    }
  // Joint poses at 2.6 m are good to a millimetre (see panel_pose_sample_test), dead reckoning in between
  // too.
  const Json& best = result["tasks"]["TL5_IMPROVED"]["smoother_measures"]["against_reference"];
  EXPECT_LT(best["position_mean_m"].get<double>(), 0.01);
  EXPECT_LT(best["angle_mean_deg"].get<double>(), 0.1);
  EXPECT_GT(readTextFile(out / "report.html").size(), 10'000U);

  // The detections are kept beside the recording; with them, the same command gives the same bytes.
  const auto kept = detectionsBeside(folder_ / "rec/dive.rawlog");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].extension(), ".gz");
  const auto written = fs::last_write_time(kept[0]);
  const auto second = localize(recording() + kFiveTasks, out);
  EXPECT_EQ(second.out, first.out);
  EXPECT_TRUE(readTextFile(out / "result.json") == bytes);
  EXPECT_EQ(detectionsBeside(folder_ / "rec/dive.rawlog"), kept);
  EXPECT_EQ(fs::last_write_time(kept[0]), written);

  if (test::runShell("command -v rawlog-edit").status != 0) GTEST_SKIP() << "needs rawlog-edit (mrpt-apps)";
  const auto info = test::runShell("rawlog-edit --info -i " +
                                   test::shellQuoted((out / "dive_results.rawlog").string()) + " 2>&1");
  EXPECT_EQ(info.status, 0) << info.out;
  EXPECT_NE(
      info.out.find("EKF_TL1, EKF_TL1_IMPROVED, EKF_TL2, EKF_TL2_IMPROVED, EKF_TL3, EKF_TL3_IMPROVED, "
                    "EKF_TL4, EKF_TL4_IMPROVED, EKF_TL5, EKF_TL5_IMPROVED, MARKERS, MARKER_SIGHTS, PANEL"),
      std::string::npos)
      << info.out;
}

// Its map's pose is not believed: the panel is found where it is, relative to where the path starts.
TEST_F(LocalizeTasks, FindsAPanelWhosePoseIsUnknown) {
  const fs::path out = test::scratchFolder() / "out";
  const std::string task = recording() + " --tasks TL5 --start reference";
  ASSERT_EQ(localize(task, out / "known").status, 0);
  const auto done = localize(task + " --panel-unknown", out / "unknown");
  ASSERT_EQ(done.status, 0) << done.err;
  const auto panelOf = [&](const char* run) {
    return jsonOf(out / run / "result.json")["tasks"]["TL5_IMPROVED"]["panels"].at(0);
  };
  const Json known = panelOf("known"), found = panelOf("unknown");
  EXPECT_EQ(known["state"], "known");
  EXPECT_EQ(found["state"], "estimated");
  double squared_m2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_GT(found["position_sigma_m"][axis].get<double>(), 0.0);
    const double off_m =
        found["position_odom_m"][axis].get<double>() - known["position_odom_m"][axis].get<double>();
    squared_m2 += off_m * off_m;
  }
  EXPECT_LT(std::sqrt(squared_m2), 0.1);  // the start's yaw is believed to 0.5 deg, 2.6 m away, and 0.1 m
}

// Of another day, say: what it cannot judge is said, and needed only for the start.
TEST_F(LocalizeTasks, SaysThatAReferenceHasNoTimeInCommon) {
  const fs::path folder = test::scratchFolder(), reference = folder / "other_day.tum";
  writeTextFile(reference, "1000 0 0 0 0 0 0 1\n1001 0 0 0 0 0 0 1\n");
  const std::string task =
      recording() + " --tasks TL2 --paper-only --reference " + test::shellQuoted(reference);
  const auto done = localize(task, folder / "out");
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(countOf(done.out, "note: other_day.tum has no time in common with the recording"), 1U)
      << done.out;
  test::expectBadInput(localize(task + " --start reference", folder / "out"), "the reference has no pose");
}

TEST_F(LocalizeTasks, FaultsActOnTheWay) {
  const fs::path folder = test::scratchFolder();
  writeTextFile(folder / "outage.yaml",
                "stages:\n  - {kind: outage, sensors: [DVL], begin_s: 10, duration_s: 100}\n");
  const std::string task = recording() + " --tasks TL2 --paper-only --start reference";
  const auto dvlFused = [&](const std::string& more) {
    const auto done = localize(task + more, folder / "out");
    EXPECT_EQ(done.status, 0) << done.err;
    return jsonOf(folder / "out/result.json")["tasks"].begin().value()["channels"]["dvl"]["fused"].get<int>();
  };
  EXPECT_NEAR(dvlFused(" --faults config/degrade_dvl_outage.yaml"), 100, 2);  // begins after a minute
  EXPECT_NEAR(dvlFused(" --faults " + test::shellQuoted((folder / "outage.yaml").string())), 50, 2);
}

TEST_F(LocalizeTasks, ABatchSurvivesABrokenRecording) {
  const fs::path folder = test::scratchFolder();
  simulate(folder, "blind", "--without camera --seed 2");
  writeTextFile(folder / "garbage.rawlog", readTextFile(folder_ / "rec/dive.rawlog").substr(1000, 5000));
  const std::string command = recording() + " " + test::shellQuoted((folder / "garbage.rawlog").string()) +
                              " " + test::shellQuoted((folder / "blind.rawlog").string()) +
                              " --tasks TL2 --paper-only --start reference";
  const auto expectOneFailed = [&](const test::ProgramResult& done) {
    EXPECT_EQ(done.status, 2) << done.err;
    EXPECT_EQ(countOf(done.err, "garbage.rawlog"), 1U) << done.err;
    EXPECT_EQ(countOf(done.err, "\n"), 2U) << done.err;
    EXPECT_NE(done.err.find("1 of 3 recordings could not be localized"), std::string::npos) << done.err;
    EXPECT_EQ(countOf(done.out, "garbage.rawlog: failed\n"), 1U) << done.out;
    const Json summary = jsonOf(folder / "out/summary.json");
    EXPECT_EQ(summary["failed"], 1);
    EXPECT_EQ(summary["recordings"].size(), 3U);
    EXPECT_EQ(summary["table"]["rows"].at(0).at(1), "2") << "recordings of TL2";
    for (const char* name : {"dive", "blind"})
      EXPECT_TRUE(fs::exists(folder / "out" / name / "result.json")) << name;
    EXPECT_FALSE(fs::exists(folder / "out/garbage/result.json"));
  };
  const auto first = localize(command, folder / "out");
  expectOneFailed(first);
  EXPECT_EQ(countOf(first.out, ": done\n"), 2U) << first.out;
  const auto second = localize(command, folder / "out");
  expectOneFailed(second);
  EXPECT_EQ(countOf(second.out, ": done before\n"), 2U) << second.out;

  // A vehicle file that is no longer the one the result is of, though no option names it.
  const fs::path vehicle = folder / "blind_vehicle.yaml";
  writeTextFile(vehicle, readTextFile(vehicle) + "# another\n");
  const auto third = localize(command, folder / "out");
  EXPECT_EQ(countOf(third.out, "blind.rawlog: done\n"), 1U) << third.out;
  EXPECT_EQ(countOf(third.out, "dive.rawlog: done before\n"), 1U) << third.out;
}

// One recording given twice has two folders; other images of the same names are another input.
TEST_F(LocalizeTasks, ABatchSeesThatImagesHaveChanged) {
  const fs::path out = test::scratchFolder() / "out";
  const std::string command = recording() + " " + recording() + " --tasks TL1 --paper-only --start reference";
  const auto doneBefore = [&] {
    const auto done = localize(command, out);
    EXPECT_EQ(done.status, 0) << done.err;
    return countOf(done.out, ": done before\n");
  };
  EXPECT_EQ(doneBefore(), 0U);
  EXPECT_TRUE(fs::exists(out / "dive_2/result.json"));
  EXPECT_EQ(doneBefore(), 2U);
  const fs::path images = folder_ / "rec/dive_Images";
  fs::copy_file(images / "CAMERA_0008.jpg", images / "CAMERA_0007.jpg", fs::copy_options::overwrite_existing);
  EXPECT_EQ(doneBefore(), 0U);
}

TEST_F(LocalizeTasks, BadInputIsOneLine) {
  const fs::path out = test::scratchFolder() / "out";
  test::expectBadInput(localize(recording() + " --tasks TL9", out), "config/TL9.yaml");
  test::expectBadInput(localize(recording() + " --tasks TL1 --config config/TL2.yaml", out), "--config");
  test::expectBadInput(localize(recording() + " --tasks TL1,TL1", out), "another task of that name");
  test::expectBadInput(localize(recording() + " --tasks TL1 --improved absent.yaml", out), "absent.yaml");
  EXPECT_FALSE(fs::exists(out / "result.json"));
}

TEST_F(LocalizeTasks, StressSaysWhatEachFaultDoes) {
  const fs::path folder = test::scratchFolder();
  writeTextFile(folder / "faults.yaml",
                "faults:\n"
                "  - {name: slow, kind: drop, sensors: [DVL], vary: probability, strengths: [0.1, 0.5]}\n"
                "  - {name: blind, kind: outage, sensors: [LANDMARKS], begin_s: 5, vary: duration_s, "
                "strengths: [2, 100]}\n");
  const auto done = fathomAtHome("stress " + recording() + " --start reference --faults " +
                                 test::shellQuoted((folder / "faults.yaml").string()) + " --out " +
                                 test::shellQuoted((folder / "out").string()));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_TRUE(fs::exists(folder / "out/report.html"));
  using Outcome = StressRun::Outcome;
  std::set<std::string> known;
  for (const Outcome outcome :
       {Outcome::unharmed, Outcome::recovered, Outcome::lost, Outcome::silent, Outcome::not_started})
    known.insert(nameOf(outcome));
  const Json result = jsonOf(folder / "out/result.json");
  EXPECT_EQ(result["task"], "TL5 improved");
  std::vector<std::string> order;
  for (const Json& run : result["runs"]) {
    order.push_back(run["fault"]);
    EXPECT_TRUE(known.count(run["outcome"])) << run["outcome"];
  }
  EXPECT_EQ(order, (std::vector<std::string>{"none", "slow", "slow", "blind", "blind"}));
  const Json &none = result["runs"].at(0), &dark = result["runs"].at(4);
  EXPECT_EQ(none["outcome"], nameOf(Outcome::unharmed));
  EXPECT_EQ(dark["strength"], 100.0);
  // Fifteen seconds on INS and DVL alone cost something.
  EXPECT_GT(dark["final_error_m"].get<double>(), none["final_error_m"].get<double>());
}

TEST_F(LocalizeTasks, TakesTheNoiseThatTuneFinds) {
  if (test::kSanitized) GTEST_SKIP() << "a thousand runs of the filter";
  const fs::path scratch = test::scratchFolder(), folder = scratch / "tuned";
  const auto tuned =
      fathomAtHome("tune " + recording() + " --block 2 --out " + test::shellQuoted(folder.string()));
  ASSERT_EQ(tuned.status, 0) << tuned.err;
  for (const char* file : {"report.html", "result.json", "localize.yaml", "robot_localization.yaml"})
    EXPECT_TRUE(fs::exists(folder / file)) << file;
  const Json result = jsonOf(folder / "result.json");
  EXPECT_GT(result["judged_gain_per_innovation"].get<double>(), 0.0);
  for (const Json& p : result["parameters"]) {
    EXPECT_LE(p["interval95"][0].get<double>(), p["after"].get<double>()) << p;
    EXPECT_GE(p["interval95"][1].get<double>(), p["after"].get<double>()) << p;
  }
  const auto done = localize(
      recording() + " --config " + test::shellQuoted((folder / "localize.yaml").string()), scratch / "out");
  EXPECT_EQ(done.status, 0) << done.err;
}

}  // namespace
}  // namespace fathom
