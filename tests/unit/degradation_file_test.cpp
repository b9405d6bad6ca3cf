#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "sources/degradation.h"
#include "support/shared_data.h"
#include "support/streams.h"

// What YAML says of degradation, and strengths as `stress` changes them.
namespace fathom {
namespace {

using test::stage;

// ---- strengths

TEST(DegradationFile, ScalesAllStrengthsAndNothingElse) {
  const auto noise =
      stage("kind: noise, sensors: [INS], gyro_rad_s: [0.1, 0, 0], accelerometer_m_s2: 1").scaled(2);
  EXPECT_EQ(std::get<NoiseFault>(noise.fault).sigma.of("gyro_rad_s"), Vector3d(0.2, 0, 0));
  EXPECT_EQ(std::get<NoiseFault>(noise.fault).sigma.of("accelerometer_m_s2"), Vector3d(2, 2, 2));
  const auto reorder = stage("kind: reorder, sensors: [INS], probability: 0.4, within_s: 3").scaled(5);
  EXPECT_EQ(std::get<ReorderFault>(reorder.fault).probability, 1.0);
  EXPECT_EQ(std::get<ReorderFault>(reorder.fault).within_s, 3.0);
}

TEST(DegradationFile, SetsOneStrength) {
  const auto bias = stage("kind: bias, sensors: [DVL], velocity_m_s: [1, -2, 0]");
  EXPECT_EQ(std::get<BiasFault>(bias.with("velocity_m_s", 4).fault).offset.of("velocity_m_s"),
            Vector3d(2, -4, 0));
  EXPECT_EQ(std::get<BiasFault>(bias.with("pressure_pa", 4).fault).offset.of("pressure_pa").x(), 4);
  EXPECT_THROW(bias.with("probability", 1), std::invalid_argument);
  EXPECT_THROW(stage("kind: drop, sensors: [DVL], probability: 0").with("probability", 1.1),
               std::invalid_argument);
}

// ---- what YAML may say

std::string flawOf(const std::string& keys) {
  try {
    stage(keys);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(DegradationFile, SaysWhatIsWrong) {
  const auto says = [](const std::string& keys, const std::string& what) {
    EXPECT_NE(flawOf(keys).find(what), std::string::npos) << keys << " -> " << flawOf(keys);
  };
  says("kind: dorp, sensors: [DVL]", "`dorp` is none of drop, delay, jitter, noise");
  says("kind: drop, sensors: [DLV], probability: 1", "`DLV` is none of INS, DVL");
  says("kind: drop, sensors: [TRUTH], probability: 1", "`TRUTH` is none of");
  says("kind: drop, sensors: [], probability: 1", "must not be empty");
  says("kind: drop, sensors: [DVL]", "missing key `probability`");
  says("kind: drop, sensors: [DVL], probability: 1.5", "must be at most 1");
  says("kind: drop, sensors: [DVL], probability: -1", "must not be negative");
  says("kind: drop, sensors: [DVL], probability: 1, delay_s: 3", "unknown key");
  says("kind: drop, sensors: [DVL], probability: 1, begin_s: 3, end_s: 2", "must be later than begin_s");
  says("kind: drop, sensors: [DVL], probability: 1, seed: -2", "must not be negative");
  says("kind: outage, sensors: [DVL], duration_s: 3, repeat_s: 0", "must be greater than zero");
  says("kind: noise, sensors: [DVL]", "says nothing for DVL: velocity_m_s");
  says("kind: noise, sensors: [DVL, INS], velocity_m_s: 1",
       "says nothing for INS: gyro_rad_s, accelerometer_m_s2");
  says("kind: noise, sensors: [DVL], velocity_m_s: 1, range_m: 1",
       "range_m concerns none of the stage's sensors");
  says("kind: noise, sensors: [DVL], velocity_m_s: [1, 2]", "must have three numbers");
  says("kind: noise, sensors: [CAMERA], position_m: 1", "CAMERA has no values to change");
  says("kind: corrupt, sensors: [STEREO], probability: 1", "STEREO has no values to change");
  says("kind: corrupt, sensors: [DVL], probability: 1, as: [odd]", "`odd` is none of nan, huge, wild");
}

TEST(DegradationFile, ReadsAListOfStages) {
  const auto file = test::scratchFolder() / "degrade.yaml";
  writeTextFile(file,
                "stages:\n  - {kind: drop, sensors: [DVL], probability: 0.5}\n  - {kind: delay, sensors: "
                "[LANDMARKS, INS], delay_s: 1, seed: 9}\n");
  const auto stages = readDegradation(file);
  ASSERT_EQ(stages.size(), 2U);
  EXPECT_EQ(stages[0].kind(), "drop");
  EXPECT_EQ(stages[1].seed, 9U);
  for (const char* label : {labels::kMarkers, labels::kPanel, labels::kIns})
    EXPECT_TRUE(stages[1].concerns(label));
  EXPECT_FALSE(stages[1].concerns(labels::kDvl));
  EXPECT_FALSE(stages[1].concerns(labels::kMarkerSights));
}

}  // namespace
}  // namespace fathom
