// The shipped tasks: each says only in what it differs from the one before, as the paper has it.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "tasks/task_spec.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const std::vector<std::string> kPaperTasks{"TL1", "TL2", "TL3", "TL4", "TL5"};

LocalizationOptions shippedTask(const std::string& name) {
  return readLocalizationOptions(test::kConfig / (name + ".yaml"));
}

/// Names of the lines in which two tasks differ, all values being spelled out.
std::set<std::string> differences(const LocalizationOptions& a, const LocalizationOptions& b) {
  const auto lines = [](const LocalizationOptions& options) {
    std::istringstream in(formatLocalizationOptions(options));
    std::vector<std::string> result;
    for (std::string line; std::getline(in, line);) result.push_back(line);
    return result;
  };
  const auto x = lines(a), y = lines(b);
  EXPECT_EQ(x.size(), y.size());
  std::set<std::string> names;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
    if (x[i] != y[i]) names.insert(x[i].substr(0, x[i].find(':')));
  return names;
}

using Names = std::set<std::string>;
using Channels = std::vector<Channel>;

// paper.md: T_L1 landmarks only, T_L2 INS and DVL, T_L3 both, T_L4 the covariance of T_P, T_L5 a fixed gate.
TEST(TaskOptions, EachTaskDiffersInOneThingFromTheOneBefore) {
  EXPECT_EQ(differences(shippedTask("TL1"), shippedTask("TL2")), (Names{"task", "fuse"}));
  EXPECT_EQ(differences(shippedTask("TL2"), shippedTask("TL3")), (Names{"task", "fuse"}));
  EXPECT_EQ(differences(shippedTask("TL3"), shippedTask("TL4")), (Names{"task", "landmarks"}));
  EXPECT_EQ(differences(shippedTask("TL4"), shippedTask("TL5")), (Names{"task", "gate"}));
}

TEST(TaskOptions, ValuesAreThePapers) {
  const Channels odometry{kChannel<Gyro>, kChannel<Accelerometer>, kChannel<Dvl>, kChannel<DvlBeams>};
  Channels all = odometry;
  all.push_back(kChannel<Landmark>);
  EXPECT_EQ(shippedTask("TL1").fuse, Channels{kChannel<Landmark>});
  EXPECT_EQ(shippedTask("TL2").fuse, odometry);
  EXPECT_EQ(shippedTask("TL3").fuse, all);
  EXPECT_EQ(shippedTask("TL5").fuse, all);
  for (const char* name : {"TL1", "TL3"}) {  // 1e-3 m2 and 1e-3 rad2, written to three digits
    const LandmarkOptions landmarks = shippedTask(name).landmarks;
    EXPECT_NEAR(landmarks.position_sigma_m * landmarks.position_sigma_m, 1e-3, 2e-6) << name;
    EXPECT_NEAR(landmarks.angle_sigma_rad * landmarks.angle_sigma_rad, 1e-3, 3e-6) << name;
  }
  for (const char* name : {"TL4", "TL5"}) {
    EXPECT_EQ(shippedTask(name).landmarks.position_sigma_m, 0.126) << name;
    EXPECT_NEAR(degrees(shippedTask(name).landmarks.angle_sigma_rad), 4.6, 1e-9) << name;
  }
  EXPECT_EQ(shippedTask("TL4").gate.kind, Gate::Kind::none);
  const Gate gate = shippedTask("TL5").gate;
  EXPECT_EQ(gate.kind, Gate::Kind::fixed);
  EXPECT_EQ(gate.max_position_m, 1.0);
  EXPECT_NEAR(degrees(gate.max_angle_rad), 12.0, 1e-9);
  for (const std::string& name : kPaperTasks) {
    EXPECT_EQ(shippedTask(name).task, name);
    EXPECT_FALSE(shippedTask(name).bias_states) << name;
    EXPECT_EQ(shippedTask(name).landmarks.form, LandmarkOptions::Form::mean) << name;
  }
}

TEST(TaskOptions, ImprovedKeepsNameAndWhatIsFused) {
  for (const std::string& name : kPaperTasks) {
    const LocalizationOptions paper = shippedTask(name);
    const LocalizationOptions improved = readLocalizationOptions(test::kConfig / "improved.yaml", paper);
    EXPECT_EQ(improved.task, name);
    EXPECT_EQ(improved.fuse, paper.fuse) << name;
    EXPECT_TRUE(improved.bias_states && improved.smooth) << name;
    EXPECT_EQ(improved.landmarks.form, LandmarkOptions::Form::joint) << name;
    EXPECT_EQ(improved.gate.kind, Gate::Kind::chi_square) << name;
    EXPECT_EQ(differences(paper, improved).count("lost"), 0U) << name;
  }
}

TEST(TaskOptions, AllShippedReadBackToTheSame) {
  const fs::path again = test::scratchFolder() / "again.yaml";
  std::vector<std::string> names = kPaperTasks;
  names.insert(names.end(), {"improved", "defaults", "navigation", "sea_trial", "husky"});
  for (const std::string& name : names) {
    const std::string text = formatLocalizationOptions(shippedTask(name));
    writeTextFile(again, text);
    EXPECT_EQ(formatLocalizationOptions(readLocalizationOptions(again)), text) << name;
  }
}

TEST(TaskOptions, BasesAreRelativeToTheFileThatNamesThem) {
  const fs::path folder = test::scratchFolder();
  fs::create_directories(folder / "deep");
  writeTextFile(folder / "first.yaml", "task: first\ngap_s: 3\nhistory_s: 4\n");
  writeTextFile(folder / "deep/second.yaml", "base: ../first.yaml\nhistory_s: 5\n");
  writeTextFile(folder / "third.yaml", "base: deep/second.yaml\ntask: third\n");
  const LocalizationOptions options = readLocalizationOptions(folder / "third.yaml");
  EXPECT_EQ(options.task, "third");
  EXPECT_EQ(options.gap_s, 3.0);
  EXPECT_EQ(options.history_s, 5.0);
}

TEST(TaskOptions, BasesThatCannotBeReadAreNamed) {
  const fs::path folder = test::scratchFolder();
  writeTextFile(folder / "a.yaml", "base: b.yaml\n");
  writeTextFile(folder / "b.yaml", "base: a.yaml\n");
  writeTextFile(folder / "self.yaml", "base: self.yaml\n");
  writeTextFile(folder / "lonely.yaml", "base: absent.yaml\n");
  const auto complaint = [&](const char* name) -> std::string {
    try {
      readLocalizationOptions(folder / name);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_NE(complaint("a.yaml").find("name each other in a circle"), std::string::npos);
  EXPECT_NE(complaint("self.yaml").find("in a circle"), std::string::npos);
  EXPECT_NE(complaint("lonely.yaml").find("absent.yaml"), std::string::npos);
}

TEST(TaskOptions, NamesForPeopleAndForFiles) {
  const TaskSpec paper{shippedTask("TL2"), false}, improved{shippedTask("TL5"), true};
  EXPECT_EQ(paper.name(), "TL2");
  EXPECT_EQ(paper.id(), "TL2");
  EXPECT_FALSE(paper.fusesLandmarks());
  EXPECT_EQ(improved.name(), "TL5 improved");
  EXPECT_EQ(improved.id(), "TL5_IMPROVED");
  EXPECT_TRUE(improved.fusesLandmarks());
}

}  // namespace
}  // namespace fathom
