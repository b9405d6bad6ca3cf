#include "recording/export_csv.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/error.h"
#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {

std::vector<std::string> lines(const std::filesystem::path& file) {
  std::istringstream text(readTextFile(file));
  std::vector<std::string> result;
  for (std::string line; std::getline(text, line);) result.push_back(line);
  return result;
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result{""};
  for (const char c : line)
    if (c == ',')
      result.emplace_back();
    else
      result.back() += c;
  return result;
}

class ExportCsv : public testing::Test {
 protected:
  CsvExport exported(const std::vector<Sample>& samples) {
    writeRecording(folder / "a.rawlog", samples);
    return exportCsv(folder / "a.rawlog", folder / "tables");
  }
  std::vector<std::string> table(const std::string& name) { return lines(folder / "tables" / name); }
  std::filesystem::path folder = scratchFolder();
};

TEST_F(ExportCsv, OneTableALabel) {
  Random random(41);
  const auto samples = randomSamples(10 * kKinds, random);
  const CsvExport result = exported(samples);
  EXPECT_FALSE(result.loss);
  EXPECT_TRUE(result.left_out.empty());  // of the header comment nothing is said
  std::vector<std::string> names;
  for (const auto& file : result.files) names.push_back(file.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"ALTIMETER.csv", "CAMERA.csv", "COMPASS.csv", "DEPTH.csv",
                                             "DVL.csv", "DVL_BEAMS.csv", "EKF_TL2.csv", "GNSS.csv", "INS.csv",
                                             "MARKER_SIGHTS.csv", "PANEL.csv", "STEREO.csv", "USBL.csv"}));
  for (const std::string& name : names) {
    const auto rows = table(name);
    const bool list = name == "PANEL.csv" || name == "MARKER_SIGHTS.csv";  // a row for each thing seen
    ASSERT_TRUE(list ? rows.size() > 11U : rows.size() == 11U) << name;
    if (name == "STEREO.csv") continue;  // its cells are quoted
    for (const std::string& row : rows) EXPECT_EQ(cells(row).size(), cells(rows[0]).size()) << name;
  }
}

TEST_F(ExportCsv, WhatIsSeenHasARowEach) {
  PanelSample none, two;
  two.panels = {{3, {Pose{Matrix3d::Identity(), {0.5, 0.25, 2}}, Matrix6d::Identity()}}, {1, {}}};
  exported({{kStart, labels::kPanel, none}, {kStart, labels::kPanel, two}});
  const auto rows = table("PANEL.csv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_TRUE(rows[0].starts_with("time_unix_s,time_s,panel,x_camera_m,")) << rows[0];
  EXPECT_TRUE(rows[0].ends_with(",cov_rz_rz_rad2")) << rows[0];
  EXPECT_TRUE(rows[1].starts_with("1700000000.0000000,0.0000000,3,0.5,0.25,2,0,0,0,1,0.99999")) << rows[1];
  EXPECT_TRUE(rows[2].starts_with("1700000000.0000000,0.0000000,1,")) << rows[2];
}

TEST_F(ExportCsv, ValuesKeepFullPrecision) {
  const Vector3d w(0.1, -1.0 / 3.0, 1e-300);
  exported({{after(kStart, 0.25), labels::kIns, InsSample{{}, w, Vector3d(1, 2, 9.81), {}}},
            {after(kStart, 0.2600001), labels::kIns, InsSample{{}, {}, Vector3d(1, 2, 9.81), {}}}});
  const auto rows = table("INS.csv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0],
            "time_unix_s,time_s,angular_velocity_ins_x_rad_s,angular_velocity_ins_y_rad_s,"
            "angular_velocity_ins_z_rad_s,specific_force_ins_x_m_s2,specific_force_ins_y_m_s2,"
            "specific_force_ins_z_m_s2,q_odom_ins_x,q_odom_ins_y,q_odom_ins_z,q_odom_ins_w");
  const auto first = cells(rows[1]);
  EXPECT_EQ(first[0], "1700000000.2500000");
  EXPECT_EQ(first[1], "0.2500000");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(std::stod(first[2 + i]), w[static_cast<Eigen::Index>(i)]);
  EXPECT_EQ(rows[2], "1700000000.2600001,0.2600001,NaN,NaN,NaN,1,2,9.81,NaN,NaN,NaN,NaN");
}

TEST_F(ExportCsv, OddLabelsAndFileNames) {
  Random random(42);
  Sample pose = randomSample(5, kStart, random);
  pose.label = "EKF/T L2";
  const CsvExport result = exported({pose, randomSample(7, kStart, random)});
  ASSERT_EQ(result.files.size(), 2U);
  EXPECT_EQ(result.files[0].filename(), "EKF%2FT%20L2.csv");
  EXPECT_EQ(cells(table("EKF%2FT%20L2.csv")[0]).size(), 2U + 7U + 21U);
  EXPECT_EQ(table("STEREO.csv")[1], "1700000000.0000000,0.0000000,left.png,\"right, \"\"odd\"\".png\"");
}

TEST_F(ExportCsv, ChangingBeamsAreAnError) {
  DvlBeamsSample four, three;
  four.beams.resize(4);
  three.beams.resize(3);
  EXPECT_THROW(exported({{kStart, labels::kDvlBeams, four}, {after(kStart, 1), labels::kDvlBeams, three}}),
               Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "tables" / "DVL_BEAMS.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "tables" / "DVL_BEAMS.csv.part"));
}

TEST_F(ExportCsv, DamageIsReported) {
  Random random(43);
  writeRecording(folder / "whole.rawlog", randomSamples(100 * kKinds, random));
  const std::string plain = inflated(folder / "whole.rawlog");
  writeTextFile(folder / "cut.rawlog", plain.substr(0, plain.size() - 10));
  const CsvExport result = exportCsv(folder / "cut.rawlog", folder / "tables");
  EXPECT_TRUE(result.loss);
  EXPECT_EQ(table("INS.csv").size(), 101U);
}

TEST_F(ExportCsv, SharedSample) {
  FATHOM_NEEDS_SHARED("data/sample/none");
  exportCsv(sharedData("data/sample/none/recording.rawlog"), folder / "tables");
  EXPECT_EQ(table("INS.csv").size(), 18002U);
  EXPECT_EQ(table("DVL.csv").size(), 901U);
}

}  // namespace
}  // namespace fathom::test
