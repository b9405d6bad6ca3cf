// Commands that are killed outright at any moment: the next run is not disturbed by what was left, and makes
// the same bytes. (`fathom batch`: batch_command_test.cpp.)
#include <gtest/gtest.h>

#include <map>

#include "core/files.h"
#include "core/random.h"
#include "core/text.h"
#include "support/folder_contents.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "support/small_vehicle.h"
#include "support/videos.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::contentsOf;
using test::fathomProgram;
using test::runShell;
using test::scratchFolder;
using test::shellQuoted;

/// `arguments` write into the folder OUT, where they are run.
void expectSameAfterBeingKilled(const std::string& arguments, int times, double longest_s) {
  const fs::path whole = scratchFolder() / "whole", killed = scratchFolder() / "killed";
  for (const fs::path& folder : {whole, killed}) fs::create_directories(folder);
  const std::string command = shellQuoted(fathomProgram()) + " " + arguments;
  const auto in = [&](const fs::path& folder, const std::string& what) {
    return runShell("cd " + shellQuoted(folder.string()) + "; " + what);
  };
  ASSERT_EQ(in(whole, command).status, 0);
  Random random(7);
  for (int i = 0; i < times; ++i) {
    const std::string moment_s = std::to_string(random.uniform(0, longest_s));
    in(killed, command + " & sleep " + moment_s + "; kill -KILL $!; wait $!");
    // What lies there under its real name is whole, at any moment.
    for (const auto& [name, text] : contentsOf(killed))
      if (!name.ends_with(".part")) EXPECT_TRUE(contentsOf(whole).contains(name)) << name;
  }
  const auto last = in(killed, command);
  ASSERT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(contentsOf(killed), contentsOf(whole));
}

TEST(Killed, SimulateMakesTheSameBytes) {
  expectSameAfterBeingKilled("simulate --trajectory " + test::kConfig.string() +
                                 "/dive_trajectory.yaml --vehicle " + test::kRov.string() +
                                 " --duration 120 --seed 3 --name dive --out OUT",
                             20, 1);
}

TEST(Killed, SimulateWithImagesMakesTheSameBytes) {
  expectSameAfterBeingKilled("simulate --trajectory " + test::kConfig.string() +
                                 "/trajectory_station.yaml --vehicle " + test::kRov.string() + " --map " +
                                 test::kDexrovMap.string() + " --water " + test::kConfig.string() +
                                 "/water_clear.yaml --duration 3 --seed 3 --name dive --out OUT",
                             10, 1);
}

TEST(Killed, ImportVideoMakesTheSameBytes) {
  const fs::path inputs = scratchFolder().parent_path() / "Killed.ImportVideo inputs";
  fs::remove_all(inputs);
  fs::create_directories(inputs);
  constexpr int kFilmFrames = 40;
  test::writeVideo(inputs / "dive.avi", "MJPG", kFilmFrames);
  std::string stamps;
  for (int k = 0; k < kFilmFrames; ++k) stamps += print("%.2f\n", 1'700'000'000.0 + 0.04 * k);
  writeTextFile(inputs / "stamps.csv", stamps);
  expectSameAfterBeingKilled("import video " + shellQuoted((inputs / "dive.avi").string()) + " --stamps " +
                                 shellQuoted((inputs / "stamps.csv").string()) + " --vehicle " +
                                 shellQuoted(test::writeSmallVehicle(inputs).string()) + " --out OUT",
                             10, 0.3);
}

TEST(Killed, LocalizeMakesTheSameBytes) {
  expectSameAfterBeingKilled(
      "localize " + test::kSource.string() + "/rawlogs/dive/dive.rawlog --start reference --smooth --out OUT",
      20, 1.5);
}

}  // namespace
}  // namespace fathom
