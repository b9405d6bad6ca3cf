// The program as people meet it: exit status, one line of complaint, help, completion, whole files or none.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/version.h"
#include "recording/rawlog.h"
#include "sensors/vehicle.h"
#include "support/bags.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::runShell;
using test::scratchFolder;
using test::shellQuoted;

const std::string kConfigs = (test::kConfig / "").string();

std::string simulateArguments(const fs::path& folder) {
  return "simulate --trajectory " + shellQuoted(kConfigs + "dive_trajectory.yaml") + " --vehicle " +
         shellQuoted(kConfigs + "rov.yaml") + " --duration 20 --name sim --out " +
         shellQuoted(folder.string());
}

TEST(CommandLine, HelpTeaches) {
  const auto help = runFathom("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.err, "");
  for (const char* part : {"Examples", "Exit status", "Documentation", "simulate", "info"})
    EXPECT_NE(help.out.find(part), std::string::npos) << part;
  EXPECT_TRUE(
      std::regex_match(runFathom("--version").out,
                       std::regex("fathom " + std::string(programVersion()) + R"( \(commit \S+\)\n)")));
}

TEST(CommandLine, EveryCommandHasHelpWithExamples) {
  const auto commands = runShell("eval \"$(" + shellQuoted(test::fathomProgram()) +
                                 " completion bash)\"; COMP_WORDS=(fathom ''); COMP_CWORD=1; _fathom; "
                                 "printf '%s\\n' \"${COMPREPLY[@]}\" | grep -v '^-'");
  std::istringstream names(commands.out);
  int count = 0;
  for (std::string name; std::getline(names, name); ++count) {
    const auto help = runFathom(name + " --help");
    EXPECT_EQ(help.status, 0) << name;
    EXPECT_NE(help.out.find("Examples"), std::string::npos) << name;
  }
  EXPECT_GE(count, 4) << commands.err;
}

TEST(CommandLine, MistakesAreOneLineAndStatusTwo) {
  const auto folder = scratchFolder();
  test::expectBadInput(runFathom(""), "fathom --help");
  test::expectBadInput(runFathom("simulte"), "simulte");
  test::expectBadInput(runFathom("info"), "RECORDING");
  test::expectBadInput(runFathom("info /no/such.rawlog"), "/no/such.rawlog");
  test::expectBadInput(runFathom("info " + shellQuoted(kConfigs + "rov.yaml")), "rov.yaml");
  test::expectBadInput(runFathom(simulateArguments(folder) + " --seed many"), "--seed");
  test::expectBadInput(runFathom(simulateArguments(folder) + " --calibration /no/such.yaml"),
                       "/no/such.yaml");
  test::expectBadInput(runFathom(simulateArguments("/proc/nowhere")), "/proc/nowhere");
  test::expectBadInput(runFathom("completion tcsh"), "tcsh");
  EXPECT_TRUE(fs::is_empty(folder)) << "a failed run left files";
}

TEST(CommandLine, FullDiskIsNoSuccess) {
  const auto result = runFathom("completion bash >/dev/full");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("standard output"), std::string::npos);
}

TEST(CommandLine, SimulateThenInfoRoundTrip) {
  const auto folder = scratchFolder();
  const auto made = runFathom(simulateArguments(folder) + " --seed 5");
  ASSERT_EQ(made.status, 0) << made.err;
  for (const char* name : {"sim.rawlog", "sim_vehicle.yaml", "sim_truth.tum", "sim_simulation.json"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  const auto summary = nlohmann::json::parse(readTextFile(folder / "sim_simulation.json"));
  EXPECT_EQ(summary["run"]["seed"], 5);
  EXPECT_EQ(summary["duration_s"], 20.0);

  const auto info = runFathom("info --json " + shellQuoted((folder / "sim.rawlog").string()));
  ASSERT_EQ(info.status, 0) << info.err;
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json["duration_s"], 20.0);
  EXPECT_TRUE(json["disagreements"].empty()) << json["disagreements"];
  EXPECT_EQ(json["compared_with"], (folder / "sim_vehicle.yaml").string());
}

TEST(CommandLine, ImportSaysWhatItConcluded) {
  const auto folder = scratchFolder();
  const std::string out = " --out " + shellQuoted((folder / "out").string());
  test::expectBadInput(runFathom("import csv " + shellQuoted(folder.string()) + " --section 3" + out),
                       "trajectory3");
  test::expectBadInput(
      runFathom("import bag /no/such.bag --topics " + shellQuoted(kConfigs + "husky_topics.yaml") + out),
      "/no/such.bag");
  EXPECT_FALSE(fs::exists(folder / "out" / "such.rawlog"));

  FATHOM_NEEDS_SHARED("data/robot_localization/test1.bag");
  const auto bag = test::sharedData("data/robot_localization/test1.bag").string();
  const auto made = runFathom("import bag " + shellQuoted(bag) + " --topics " +
                              shellQuoted(kConfigs + "husky_topics.yaml") + " --name husky" + out);
  ASSERT_EQ(made.status, 0) << made.err;
  const auto summary = nlohmann::json::parse(readTextFile(folder / "out" / "husky_import.json"));
  ASSERT_FALSE(summary["conclusions"].empty());
  for (const auto& conclusion : summary["conclusions"])
    EXPECT_NE(made.out.find(conclusion["what"].get<std::string>()), std::string::npos) << conclusion;

  const auto info = runFathom("info --json " + shellQuoted((folder / "out" / "husky.rawlog").string()));
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out)["entries"].get<int>(), summary["samples"].get<int>() + 1)
      << "the samples and the first comment";
}

// Later or earlier than what comes in between, its entries are written in their order.
TEST(CommandLine, ImportCorrectsAClock) {
  const auto folder = scratchFolder();
  rosbag::Bag bag((folder / "dive.bag").string(), rosbag::bagmode::Write);
  for (unsigned i = 0; i < 20; ++i) {
    bag.write("/imu", test::rosTime(100 + i), test::imuMessage(test::rosTime(100 + i)));
    bag.write("/dvl", test::rosTime(100 + i), test::stamped<ros1::TwistStamped>(test::rosTime(100 + i)));
  }
  bag.close();
  const std::string pose = "    pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}\n";
  writeTextFile(folder / "topics.yaml",
                "topics:\n  - topic: /imu\n    as: INS\n" + pose + "  - topic: /dvl\n    as: DVL\n" + pose);
  for (const double offset_s : {-2.5, 2.5}) {
    const auto made = runFathom("import bag " + shellQuoted((folder / "dive.bag").string()) + " --topics " +
                                shellQuoted((folder / "topics.yaml").string()) + " --out " +
                                shellQuoted((folder / "out").string()) +
                                " --correct clock-offset:DVL:" + std::to_string(offset_s));
    ASSERT_EQ(made.status, 0) << made.err;
    std::map<std::string, std::vector<double>> seconds;
    RawlogReader reader(folder / "out" / "dive.rawlog");
    Time last{};
    while (const auto sample = reader.next()) {
      EXPECT_LE(last, sample->time);
      last = sample->time;
      seconds[sample->label].push_back(toUnixSeconds(sample->time));
    }
    ASSERT_EQ(seconds["INS"].size(), 20U);
    ASSERT_EQ(seconds["DVL"].size(), 20U);
    EXPECT_NEAR(seconds["DVL"][7] - seconds["INS"][7], offset_s, 1e-6);
  }
}

TEST(CommandLine, InfoFindsWhereRecordingAndVehicleFileDisagree) {
  const auto folder = scratchFolder();
  ASSERT_EQ(runFathom(simulateArguments(folder)).status, 0);
  std::string vehicle = readTextFile(kConfigs + "rov.yaml");
  const std::string dvl_pose = "pose: {x: -0.2,";
  ASSERT_NE(vehicle.find(dvl_pose), std::string::npos);
  vehicle.replace(vehicle.find(dvl_pose), dvl_pose.size(), "pose: {x: -0.25,");
  writeTextFile(folder / "moved.yaml", vehicle);
  const auto info = runFathom("info --json " + shellQuoted((folder / "sim.rawlog").string()) + " --vehicle " +
                              shellQuoted((folder / "moved.yaml").string()));
  ASSERT_EQ(info.status, 0) << info.err;
  const auto lines = nlohmann::json::parse(info.out)["disagreements"];
  ASSERT_EQ(lines.size(), 5u) << "the DVL and its four beams: " << lines;
  EXPECT_NE(lines[0].get<std::string>().find("0.0500 m and 0.000 deg apart"), std::string::npos) << lines[0];
}

TEST(CommandLine, InfoFindsAUsblThatSitsElsewhere) {
  const auto folder = scratchFolder();
  const auto withUsblAt = [](const std::string& x) {
    return readTextFile(kConfigs + "rov.yaml") + "usbl: {rate_hz: 1, position_sigma_m: 0.5, pose: {x: " + x +
           ", y: 0, z: 0.2, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}}\n";
  };
  writeTextFile(folder / "usbl.yaml", withUsblAt("0.1"));
  writeTextFile(folder / "moved.yaml", withUsblAt("0.15"));
  const std::string usbl = shellQuoted((folder / "usbl.yaml").string());
  const auto made = runFathom("simulate --trajectory " + kConfigs + "dive_trajectory.yaml --vehicle " + usbl +
                              " --duration 5 --name sim --out " + shellQuoted(folder.string()));
  ASSERT_EQ(made.status, 0) << made.err;
  const auto disagreements = [&](const char* vehicle) {
    const auto info = runFathom("info --json " + shellQuoted((folder / "sim.rawlog").string()) +
                                " --vehicle " + shellQuoted((folder / vehicle).string()));
    return nlohmann::json::parse(info.out)["disagreements"];
  };
  EXPECT_TRUE(disagreements("usbl.yaml").empty()) << disagreements("usbl.yaml");
  ASSERT_EQ(disagreements("moved.yaml").size(), 1U);
  EXPECT_TRUE(disagreements("moved.yaml")[0].get<std::string>().starts_with("USBL: mounted at"));
}

TEST(CommandLine, NamedVehicleFileThatIsMissingIsAnErrorButForInfo) {
  const auto folder = scratchFolder();
  ASSERT_EQ(runFathom(simulateArguments(folder)).status, 0);
  fs::remove(folder / "sim_vehicle.yaml");
  const std::string recording = shellQuoted((folder / "sim.rawlog").string());
  test::expectBadInput(
      runFathom("localize " + recording + " --out " + shellQuoted((folder / "out").string())),
      "[recording] vehicle");
  const auto info = runFathom("info " + recording);
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_NE(info.out.find("which is not there: compared with defaults"), std::string::npos) << info.out;
  const auto json = nlohmann::json::parse(runFathom("info --json " + recording).out);
  EXPECT_TRUE(json["compared_with"].is_null());
  EXPECT_EQ(json["remarks"].size(), 1U) << json["remarks"];
}

TEST(CommandLine, NumbersAreFinite) {
  const auto folder = scratchFolder();
  const std::string camera = "import camera /no/such.yaml --out " + shellQuoted(folder.string());
  const std::string kml =
      "export kml /no/such.tum --longitude 0 --out " + shellQuoted((folder / "a.kml").string());
  for (const char* value : {"nan", "inf", "-inf", "1e999"}) {
    const std::string is = std::string("=") + value;
    test::expectBadInput(runFathom(simulateArguments(folder) + " --begin" + is),
                         "--begin: must be a finite number");
    test::expectBadInput(runFathom(camera + " --rate-hz" + is), "--rate-hz: must be a finite number");
    test::expectBadInput(runFathom(kml + " --latitude" + is), "--latitude: must be a finite number");
    test::expectBadInput(runFathom(kml + " --latitude 1 --spacing" + is),
                         "--spacing: must be a finite number");
    test::expectBadInput(
        runFathom("sil x.rawlog --out " + shellQuoted(folder.string()) + " --sea-floor-z" + is),
        "--sea-floor-z: must be a finite number");
  }
  test::expectBadInput(runFathom(camera + " --rate-hz=-1"), "--rate-hz: must be greater than zero, not -1;");
}

TEST(CommandLine, ANameIsOneOfAFileInTheFolder) {
  const auto folder = scratchFolder();
  for (const char* name : {"../x", "a/b", "/x", "..", ".", ""})
    for (const std::string& command :
         {simulateArguments(folder / "out"),
          "import camera /no/such.yaml --out " + shellQuoted((folder / "out").string())}) {
      const std::string unnamed = std::regex_replace(command, std::regex(" --name sim"), "");
      test::expectBadInput(runFathom(unnamed + " --name=" + shellQuoted(name)), "--name");
    }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST(CommandLine, AnInputInTheFolderOfOutputsIsNotWrittenOver) {
  const auto folder = scratchFolder();
  ASSERT_EQ(runFathom(simulateArguments(folder)).status, 0);
  const std::string before = readTextFile(folder / "sim_truth.tum");
  test::expectBadInput(
      runFathom("simulate --trajectory " + shellQuoted((folder / "sim_truth.tum").string()) + " --vehicle " +
                shellQuoted(test::kRov.string()) + " --name sim --out " + shellQuoted(folder.string())),
      "--trajectory names: an input is not written over");
  EXPECT_EQ(readTextFile(folder / "sim_truth.tum"), before);
}

TEST(CommandLine, AnInputIsNotWrittenOver) {
  const auto folder = scratchFolder();
  const fs::path tum = folder / "path.tum", link = folder / "link.tum";
  writeTextFile(tum, "1 0 0 -1 0 0 0 1\n2 0 0 -1 0 0 0 1\n");
  fs::create_symlink("path.tum", link);
  const std::string before = readTextFile(tum);
  for (const std::string& out : {tum.string(), link.string(), (folder / "." / "path.tum").string()})
    test::expectBadInput(runFathom("export kml " + shellQuoted(tum.string()) +
                                   " --latitude 1 --longitude 2 --out " + shellQuoted(out)),
                         "--out: " + out + ": is what FILE names");
  EXPECT_EQ(readTextFile(tum), before);
}

TEST(CommandLine, SameCommandSameBytes) {
  const auto folder = scratchFolder();
  std::vector<std::string> rawlogs;
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(runFathom(simulateArguments(folder)).status, 0);
    rawlogs.push_back(readTextFile(folder / "sim.rawlog") + readTextFile(folder / "sim_simulation.json"));
  }
  EXPECT_EQ(rawlogs[0], rawlogs[1]);
}

TEST(CommandLine, ACameraFileBecomesAVehicleFile) {
  const auto folder = scratchFolder();
  writeTextFile(folder / "chain.yaml",
                "cam0: {camera_model: pinhole, intrinsics: [500, 501, 320, 240], resolution: [640, 480],\n"
                "       distortion_model: radtan, distortion_coeffs: [-0.1, 0.01, 0, 0]}\n");
  const std::string out = " --out " + shellQuoted(folder.string());
  const auto made = runFathom("import camera " + shellQuoted((folder / "chain.yaml").string()) + out);
  ASSERT_EQ(made.status, 0) << made.err;
  const Vehicle vehicle = readVehicle(folder / "chain_vehicle.yaml");
  EXPECT_EQ(vehicle.camera.value().model.fy_px, 501);
  EXPECT_EQ(vehicle.camera.value().model.k1, -0.1);
  test::expectBadInput(runFathom("import camera " + shellQuoted(kConfigs + "rov.yaml") + out),
                       "camera_matrix");
}

// Read by a stock reader that complains about what it does not know.
TEST(CommandLine, ManualPagesAreWellFormed) {
  const auto folder = scratchFolder();
  const auto made = runFathom("man --out " + shellQuoted(folder.string()));
  ASSERT_EQ(made.status, 0) << made.err;
  const auto lint = runShell("mandoc -T lint -W error " + shellQuoted((folder / "man1").string()) + "/*.1");
  EXPECT_EQ(lint.status, 0) << lint.out << lint.err;
  const auto page = runShell("mandoc -T utf8 " + shellQuoted((folder / "man1/fathom-import-bag.1").string()) +
                             " | sed 's/.\\x08//g'");
  for (const char* part : {"NAME", "SYNOPSIS", "--topics FILE.yaml", "EXAMPLES", "fathom-import(1)"})
    EXPECT_NE(page.out.find(part), std::string::npos) << part << "\n" << page.out;
}

TEST(CommandLine, InterruptedRunLeavesNoFile) {
  const auto folder = scratchFolder();
  // A long simulation, asked to stop as soon as its first part file is there.
  const std::string command = "simulate --trajectory " + shellQuoted((folder / "long.yaml").string()) +
                              " --vehicle " + shellQuoted(kConfigs + "rov.yaml") + " --name long --out " +
                              shellQuoted((folder / "out").string());
  std::ofstream(folder / "long.yaml") << "waypoints:\n  - {x: 0, y: 0, z: -3, yaw_deg: 0}\n"
                                         "  - {x: 4, y: 0, z: -3, yaw_deg: 0, t_s: 40000}\n";
  const auto result =
      runShell(shellQuoted(test::fathomProgram()) + " " + command + " & pid=$!; until ls " +
               shellQuoted((folder / "out").string()) +
               "/*.part >/dev/null 2>&1 || ! kill -0 $pid; do sleep 0.05; done; kill -INT $pid; "
               "wait $pid");
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::is_empty(folder / "out"));
}

// ---- completion

class Completion : public testing::Test {
 protected:
  /// What bash would offer for the words typed so far, the last one unfinished; sorted, one a line.
  static std::string offered(const std::string& words, const fs::path& folder = FATHOM_SOURCE_DIR) {
    const auto result = runShell("cd " + shellQuoted(folder.string()) + "; bash -c " +
                                 shellQuoted("eval \"$(" + shellQuoted(test::fathomProgram()) +
                                             " completion bash)\"; COMP_WORDS=(" + words +
                                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _fathom; "
                                             "printf '%s\\n' \"${COMPREPLY[@]}\" | sort -u"));
    EXPECT_EQ(result.err, "");
    return result.out;
  }
};

TEST_F(Completion, ScriptIsSound) {
  fs::current_path(scratchFolder());
  const auto result = runShell(shellQuoted(test::fathomProgram()) + " completion bash | bash -n");
  EXPECT_EQ(result.status, 0) << result.err;
  for (const std::string shell : {"zsh", "fish"}) {
    EXPECT_GT(runFathom("completion " + shell).out.size(), 500u);
    // zsh and fish are no packages that the tests need; where one is at hand it reads its script.
    std::ofstream("script") << runFathom("completion " + shell).out;
    const auto checked = runShell("shell=" + shell + "; if command -v $shell; then $shell -n script; fi");
    EXPECT_EQ(checked.status, 0) << checked.err;
  }
}

TEST_F(Completion, CommandsAndOptions) {
  EXPECT_EQ(offered("fathom si"), "sil\nsimulate\n");
  EXPECT_EQ(offered("fathom simulate --se"), "--sea-floor-z\n--seed\n");
  EXPECT_EQ(offered("fathom completion z"), "zsh\n");
  EXPECT_EQ(offered("fathom simulate --without d"), "depth\ndvl\n");
  EXPECT_EQ(offered("fathom simulate --seed ''"), "\n") << "a number cannot be guessed";
}

TEST_F(Completion, FilesByKind) {
  const auto folder = scratchFolder();
  fs::create_directories(folder / "a folder");
  for (const char* name : {"a.rawlog", "a.yaml", "a.txt"}) std::ofstream(folder / name) << "x";
  EXPECT_EQ(offered("fathom info a", folder), "a folder\na.rawlog\n");
  EXPECT_EQ(offered("fathom info --vehicle a", folder), "a folder\na.yaml\n");
  EXPECT_EQ(offered("fathom simulate --out a", folder), "a folder\n");
}

}  // namespace
}  // namespace fathom
