// `fathom batch` as people meet it, and as machines fail: killed, out of disk, two at once, on a Slurm
// cluster.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::expectBadInput;
using test::runFathom;
using test::runShell;
using test::scratchFolder;
using test::shellQuoted;

/// Two short dives, and a batch over them: six jobs.
class Batch : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = scratchFolder();
    for (const char* seed : {"1", "2"}) {
      const std::string name = std::string("dive") + seed;
      const auto made =
          runFathom("simulate --trajectory " + test::kConfig.string() + "/dive_trajectory.yaml --vehicle " +
                    test::kConfig.string() + "/rov.yaml --duration 20 --seed " + seed + " --name " + name +
                    " --out " + shellQuoted((folder_ / "dives").string()));
      ASSERT_EQ(made.status, 0) << made.err;
    }
    writeTextFile(folder_ / "batch.yaml",
                  "recordings: [\"" + (folder_ / "dives").string() +
                      "\"]\n"
                      "runs:\n"
                      "  - {name: filter, command: localize, options: [--start, reference]}\n"
                      "  - {name: smooth, command: localize, options: [--start, reference, --smooth]}\n"
                      "  - {name: TL2, command: localize, options: [--tasks, \"" +
                      (test::kConfig / "TL2.yaml").string() +
                      "\", --paper-only, --start, reference]}\n"
                      "columns:\n"
                      "  - {name: \"error [m]\", at: /tasks/TL2/filter_error/position_error_mean_m}\n");
  }

  std::string arguments(const std::string& out = "out") const {
    return "batch " + shellQuoted((folder_ / "batch.yaml").string()) + " --out " +
           shellQuoted((folder_ / out).string());
  }
  nlohmann::json result(const std::string& out = "out") const {
    return nlohmann::json::parse(readTextFile(folder_ / out / "result.json"));
  }
  std::size_t countOf(const std::string& state, const std::string& out = "out") const {
    std::size_t count = 0;
    const nlohmann::json json = result(out);
    for (const auto& job : json["jobs"]) count += job["state"] == state ? 1 : 0;
    return count;
  }
  /// All that jobs have made, but times and logs: by file. Which folder it is in stands in command lines.
  std::map<std::string, std::string> madeIn(const std::string& out) const {
    std::map<std::string, std::string> files{{"jobs", result(out)["jobs"].dump()}};
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / out / "jobs")) {
      const std::string name = entry.path().filename();
      if (!entry.is_regular_file() || name == "job.json" || name == "log.txt" || name == "lock") continue;
      std::string text = readTextFile(entry.path());
      const std::string place = (folder_ / out).string();
      for (auto at = text.find(place); at != std::string::npos; at = text.find(place, at))
        text.replace(at, place.size(), "OUT");
      files[fs::relative(entry.path(), folder_ / out)] = text;
    }
    return files;
  }

  fs::path folder_;
  const std::string tests_ = test::kSource.string() + "/tests/interop/";
};

TEST_F(Batch, RunsEachJobOnce) {
  const auto first = runFathom(arguments());
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(countOf("done"), 6u);
  const nlohmann::json json = result();
  for (const auto& job : json["jobs"]) EXPECT_LT(job["columns"]["error [m]"], 0.1) << job;
  std::ifstream csv(folder_ / "out/batch.csv");
  std::string header;
  std::getline(csv, header);
  EXPECT_EQ(header, "job,recording,run,seed,state,complaint,error [m]");
  const auto record = folder_ / "out/jobs/dive1.TL2/job.json";
  const auto before = fs::last_write_time(record);
  ASSERT_EQ(runFathom(arguments()).status, 0);
  EXPECT_EQ(fs::last_write_time(record), before) << "what is done is not done again";
  EXPECT_EQ(
      test::runShell(tests_ + "open-report " + shellQuoted((folder_ / "out/report.html").string()) + " 400")
          .status,
      0);
}

TEST_F(Batch, AFailedJobStopsNoOther) {
  const fs::path recording = folder_ / "dives/dive1.rawlog";
  const std::string whole = readTextFile(recording);
  writeTextFile(recording, "no rawlog");
  const auto broken = runFathom(arguments());
  ASSERT_EQ(broken.status, 0) << broken.err;
  EXPECT_EQ(countOf("failed"), 3u);
  EXPECT_EQ(countOf("done"), 3u);
  EXPECT_NE(broken.out.find("dive1.rawlog"), std::string::npos) << "the complaint is printed";
  writeTextFile(recording, whole);
  ASSERT_EQ(runFathom(arguments()).status, 0);
  EXPECT_EQ(countOf("done"), 6u);
}

TEST_F(Batch, SharesMakeTheWhole) {
  for (const char* share : {"1/3", "2/3", "3/3"})
    ASSERT_EQ(runFathom(arguments() + " --no-report --share " + share).status, 0);
  ASSERT_EQ(runFathom(arguments("whole")).status, 0);
  ASSERT_EQ(runFathom(arguments() + " --collect").status, 0);
  EXPECT_EQ(countOf("done"), 6u);
}

TEST_F(Batch, TwoAtOnceShareTheWork) {
  const std::string command = shellQuoted(test::fathomProgram()) + " " + arguments() + " --no-report";
  ASSERT_EQ(runShell(command + " & " + command + "; first=$?; wait $! && exit $first").status, 0);
  ASSERT_EQ(runFathom(arguments() + " --collect").status, 0);
  EXPECT_EQ(countOf("done"), 6u);
}

// As by another machine.
TEST_F(Batch, AJobThatAnotherHoldsIsLeftToIt) {
  const fs::path held = folder_ / "out/jobs/dive1.filter";
  fs::create_directories(held);
  const auto beside = runShell("flock " + shellQuoted((held / "lock").string()) + " " +
                               shellQuoted(test::fathomProgram()) + " " + arguments());
  ASSERT_EQ(beside.status, 0) << beside.err;
  EXPECT_EQ(countOf("open"), 1u);
  EXPECT_EQ(countOf("done"), 5u);
}

// Killed with all it has started, at ten moments: what it has left is no obstacle, and the bytes are the
// same.
TEST_F(Batch, KilledItGoesOnWhereItWas) {
  ASSERT_EQ(runFathom(arguments("undisturbed")).status, 0);
  const std::string command = shellQuoted(test::fathomProgram()) + " " + arguments();
  for (int moment = 0; moment < 10; ++moment) {
    const std::string s = std::to_string(0.02 + 0.07 * moment);
    runShell("setsid " + command + " & pid=$!; sleep " + s + "; kill -KILL -- -$pid; wait $pid");
  }
  ASSERT_EQ(runFathom(arguments()).status, 0);
  EXPECT_EQ(madeIn("out"), madeIn("undisturbed"));
}

// A folder of 200 kB.
TEST_F(Batch, AFullDiskLosesNothing) {
  fs::create_directories(folder_ / "out");
  const std::string out = shellQuoted((folder_ / "out").string());
  const std::string small = "bwrap --dev-bind / / --size 200000 --tmpfs " + out + " ";
  if (runShell(small + "true").status != 0) GTEST_SKIP() << "no sandbox (bubblewrap) can be made here";
  const auto full = runShell(small + shellQuoted(test::fathomProgram()) + " " + arguments());
  EXPECT_EQ(full.status, 2) << full.out << full.err;
  EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
  ASSERT_EQ(runFathom(arguments()).status, 0);
  EXPECT_EQ(countOf("done"), 6u);
}

TEST_F(Batch, RefusesInOneLine) {
  const auto withConfig = [&](const std::string& text) {
    writeTextFile(folder_ / "batch.yaml", text);
    return runFathom(arguments());
  };
  const std::string dives = "recordings: [\"" + (folder_ / "dives").string() + "\"]\n";
  expectBadInput(runFathom(arguments() + " --share 3/2"), "--share");
  expectBadInput(runFathom(arguments() + " --share half"), "--share");
  expectBadInput(withConfig("recordings: [/no/such]\nruns: []\n"), "/no/such");
  expectBadInput(withConfig(dives + "runs: []\n"), "runs");
  expectBadInput(withConfig(dives + "runs: [{name: a/b, command: localize}]\n"), "name");
  expectBadInput(withConfig(dives + "runs: [{name: a, command: localize, options: [--out, x]}]\n"), "--out");
  expectBadInput(withConfig(dives + "runs: [{name: a, command: x}, {name: a, command: y}]\n"), "twice");
  expectBadInput(withConfig(dives + "runs: [{name: a, command: x, seeds: [1.5]}]\n"), "seeds");
  expectBadInput(withConfig(dives + "runs: [{name: a, command: x}]\ncolumns: [{name: b, at: no/pointer}]\n"),
                 "at");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

// A real cluster of one node. One task is queued again in mid-run, as when its node was lost.
TEST_F(Batch, RunsOnSlurm) {
  ASSERT_EQ(runFathom(arguments("here")).status, 0);
  const std::string submit = shellQuoted(test::fathomProgram()) + " " + arguments() + " --slurm --tasks 3";
  const auto run =
      runShell(tests_ + "with-slurm bash -c " +
               shellQuoted("set -e; " + submit + " | tee " + shellQuoted((folder_ / "said").string()) +
                           "; for i in $(seq 300); do "
                           "[[ -z $(squeue --noheader --states=R --jobs=1_1) ]] || break; sleep 0.02; "
                           "done; scontrol requeue 1_1 1>&2; "
                           "while squeue --noheader | grep -q .; do sleep 0.2; done"));
  if (run.status == 77) GTEST_SKIP() << run.err;
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  EXPECT_EQ(countOf("done"), 6u) << run.out << run.err;
  EXPECT_EQ(madeIn("out"), madeIn("here"));
}

}  // namespace
}  // namespace fathom
