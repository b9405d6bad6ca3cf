#include "sources/stress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

std::vector<StressFault> faults(const std::string& entries) {
  const auto file = test::scratchFolder() / "stress.yaml";
  writeTextFile(file, "faults:\n" + entries);
  return readStress(file);
}

TEST(Stress, VariesOneStrength) {
  const auto read = faults(
      "  - {name: lost, kind: drop, sensors: [DVL], vary: probability, strengths: [0.1, 0.5]}\n"
      "  - {name: off, kind: bias, sensors: [DVL], velocity_m_s: [2, 0, 0], vary: velocity_m_s, strengths: "
      "[0.1]}\n"
      "  - {name: off2, kind: bias, sensors: [DVL], vary: velocity_m_s, strengths: [0.1]}\n");
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[0].name, "lost");
  EXPECT_EQ(read[0].strengths, (std::vector<double>{0.1, 0.5}));
  EXPECT_EQ(std::get<DropFault>(read[0].at(0.5).fault).probability, 0.5);
  EXPECT_EQ(std::get<BiasFault>(read[1].at(0.1).fault).offset.of("velocity_m_s"), Vector3d(0.1, 0, 0));
  EXPECT_EQ(std::get<BiasFault>(read[2].at(0.1).fault).offset.of("velocity_m_s"), Vector3d(0.1, 0.1, 0.1));
}

TEST(Stress, VariesAllTogether) {
  const auto read = faults(
      "  - {name: noise, kind: noise, sensors: [INS], gyro_rad_s: 0.1, accelerometer_m_s2: 1, vary: factor, "
      "strengths: [1, 3]}\n");
  const Amounts sigma = std::get<NoiseFault>(read.at(0).at(3).fault).sigma;
  EXPECT_NEAR(sigma.of("gyro_rad_s").x(), 0.3, 1e-15);
  EXPECT_EQ(sigma.of("accelerometer_m_s2").x(), 3);
}

TEST(Stress, SaysWhatIsWrong) {
  const auto says = [](const std::string& keys, const std::string& what) {
    std::string complaint;
    try {
      faults("  - {name: a, " + keys + "}\n");
    } catch (const Error& error) {
      complaint = error.what();
    }
    EXPECT_NE(complaint.find(what), std::string::npos) << keys << " -> " << complaint;
  };
  const std::string drop = "kind: drop, sensors: [DVL]";
  says(drop + ", vary: probability, strengths: [0.5, 2]", "must be at most 1");
  says(drop + ", vary: probability, strengths: []", "must not be empty");
  says(drop + ", vary: delay_s, strengths: [1]", "missing key `probability`");
  says(drop + ", probability: 1, vary: delay_s, strengths: [1]", "`delay_s` is none of factor, probability");
  says(drop + ", probability: 1, vary: factor, strengths: [-1]", "must not be negative");
  says(drop + ", vary: probability, strengths: [0.5], speed: 3", "unknown key");
  says(drop + ", vary: probability, strengths: [0.5]}\n  - {name: a, " + drop +
           ", vary: probability, strengths: [1]",
       "is another fault's too");
  says("kind: noise, sensors: [DVL], vary: range_m, strengths: [1]",
       "range_m concerns none of the stage's sensors");
  says("kind: noise, sensors: [DVL, DVL_BEAMS], vary: range_m, strengths: [1]",
       "says nothing for DVL: velocity_m_s");
}

TEST(Stress, TheShippedListHasEveryKindAtThreeStrengths) {
  std::set<std::string> kinds;
  for (const StressFault& fault :
       readStress(std::filesystem::path(FATHOM_SOURCE_DIR) / "config" / "stress.yaml")) {
    kinds.insert(fault.stage.kind());
    EXPECT_EQ(fault.strengths.size(), 3U) << fault.name;
    EXPECT_TRUE(std::is_sorted(fault.strengths.begin(), fault.strengths.end())) << fault.name;
  }
  EXPECT_EQ(kinds.size(), std::variant_size_v<AnyFault>);
}

}  // namespace
}  // namespace fathom
