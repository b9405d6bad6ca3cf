// The installed package, in a prefix of its own: the program finds what it ships with, and programs of one's
// own (app/examples) build against it and do what they say.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "core/files.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runShell;
using test::shellQuoted;

class Install : public testing::Test {
 protected:
  void SetUp() override {
    if (test::kSanitized) GTEST_SKIP() << "sanitized libraries are not for others to link";
    folder_ = test::scratchFolder();
    const auto result = runShell("cmake --install " + shellQuoted(FATHOM_BINARY_DIR) + " --prefix " +
                                 shellQuoted(prefix().string()));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path prefix() const { return folder_ / "prefix"; }
  fs::path at(const std::string& name) const { return folder_ / name; }

  /// Builds a project of the installed examples, with more options for CMake.
  void build(const std::string& project, const std::string& options = "") {
    const std::string source = (prefix() / "share/doc/libfathom-dev" / project).string();
    const auto result =
        runShell("cmake -S " + shellQuoted(source) + " -B " + shellQuoted(at("build").string()) +
                 " -D CMAKE_BUILD_TYPE=None -D CMAKE_PREFIX_PATH=" + shellQuoted(prefix().string()) + " " +
                 options + " && cmake --build " + shellQuoted(at("build").string()) + " --parallel 2");
    ASSERT_EQ(result.status, 0) << result.out << result.err;
  }
  /// Runs what was built, away from the source folder.
  test::ProgramResult run(const std::string& words) {
    return runShell("cd " + shellQuoted(folder_.string()) + " && " + words);
  }

 private:
  fs::path folder_;
};

TEST_F(Install, ProgramFindsWhatItShipsWith) {
  const auto result =
      run("prefix/bin/fathom simulate --trajectory config/dive_trajectory.yaml --vehicle config/rov.yaml "
          "--duration 20 --name sim --out sim && prefix/bin/fathom localize sim/sim.rawlog "
          "--tasks TL2 --out localized");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(fs::exists(at("localized/report.html")));
  EXPECT_TRUE(fs::exists(prefix() / "share/man/man1/fathom-diagnose.1.gz"));
  EXPECT_TRUE(fs::exists(prefix() / "share/bash-completion/completions/fathom"));
}

/// Who filters needs none of the packages that images, panels and bags do, and says that it does not.
TEST_F(Install, FilterOfOnesOwnSensorNeedsLittle) {
  std::string without;
  for (const char* package : {"OpenCV", "OSMesa", "OpenMesh", "apriltag", "RosbagStorage"})
    without += std::string(" -D CMAKE_DISABLE_FIND_PACKAGE_") + package + "=ON";
  build("examples/own_sensor", without);
  const auto result = run("build/own_sensor");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("\nconsistent\n"), std::string::npos) << result.out;
}

TEST_F(Install, ExamplesSimulateLocalizeAndDiagnose) {
  build("examples");
  const std::string config = (prefix() / "share/fathom/config").string();
  const auto simulated = run("build/simulate_effect " + shellQuoted(config + "/dive_trajectory.yaml") + " " +
                             shellQuoted(config + "/rov.yaml") + " sim");
  EXPECT_EQ(simulated.out, "sim/dive_trajectory.rawlog\n") << simulated.err;
  const auto localized = run("build/localize sim/dive_trajectory.rawlog");
  EXPECT_EQ(localized.status, 0) << localized.err;
  EXPECT_NE(localized.out.find("dvl: "), std::string::npos) << localized.out;
  const auto diagnosed = run("build/diagnose sim/dive_trajectory.rawlog");
  EXPECT_EQ(diagnosed.status, 0) << diagnosed.err;
  EXPECT_TRUE(diagnosed.out.starts_with("explained: ")) << diagnosed.out;
  EXPECT_NE(diagnosed.out.find("\ndvl-scale scale_error 0.0"), std::string::npos) << diagnosed.out;
  const auto mistaken = run("build/localize none.rawlog");
  EXPECT_EQ(mistaken.status, 2);
}

TEST_F(Install, SaysWhichComponentsThereAre) {
  std::ofstream(at("CMakeLists.txt"))
      << "cmake_minimum_required(VERSION 3.23)\nproject(mistaken LANGUAGES CXX)\n"
         "find_package(fathom REQUIRED COMPONENTS localisation)\n";
  const auto result = run("cmake -S . -B build -D CMAKE_PREFIX_PATH=" + shellQuoted(prefix().string()));
  EXPECT_NE(result.status, 0);
  EXPECT_TRUE(std::regex_search(result.err, std::regex("no component localisation;\\s+there\\s+are:")))
      << result.err;  // CMake breaks lines where it likes
}

/// What the installed pages refer to is installed.
TEST_F(Install, PagesLinkToWhatIsThere) {
  const std::regex link(R"(\]\(([^)#]+)[^)]*\))");
  std::size_t links = 0;
  for (const auto& entry : fs::recursive_directory_iterator(prefix() / "share/doc")) {
    if (entry.path().extension() != ".md") continue;
    const std::string text = readTextFile(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it) {
      const std::string target = (*it)[1];
      if (target.starts_with("http")) continue;
      ++links;
      EXPECT_TRUE(fs::exists(entry.path().parent_path() / target)) << entry.path() << ": " << target;
    }
  }
  EXPECT_GT(links, 10U);
}

/// Of what is asked for if it can be had, what lacks a package is left out alone.
TEST_F(Install, LeavesOutAnOptionalComponentWithoutItsPackages) {
  std::ofstream(at("CMakeLists.txt"))
      << "cmake_minimum_required(VERSION 3.23)\nproject(sparing LANGUAGES CXX)\n"
         "find_package(fathom REQUIRED COMPONENTS core OPTIONAL_COMPONENTS imaging nonsense)\n"
         "if(NOT TARGET fathom::core OR TARGET fathom::imaging OR fathom_imaging_FOUND)\n"
         "  message(FATAL_ERROR \"not as asked\")\nendif()\n";
  const auto result =
      run("cmake -S . -B build -D CMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON -D CMAKE_PREFIX_PATH=" +
          shellQuoted(prefix().string()));
  EXPECT_EQ(result.status, 0) << result.err;
}

}  // namespace
}  // namespace fathom
