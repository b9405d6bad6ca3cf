// `fathom sil` as its user runs it, and its rawlog in the stock tools.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/sil_recordings.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

test::ProgramResult runSilOn(const RecordingFiles& recording, const std::string& more) {
  return test::runFathom("sil " + test::shellQuoted(recording.rawlog.string()) + " --water " +
                         test::shellQuoted(test::kSilWater.string()) + " " + more);
}

TEST(SilCommand, WritesWhatItSaysAndStockToolsReadIt) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder);
  fs::resize_file(recording.images / "CAMERA_0001.png", 5000);
  const fs::path out = folder / "out";
  const auto result =
      runSilOn(recording, "--sea-floor-z -6 --frames --out " + test::shellQuoted(out.string()));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(result.out.starts_with("2 pairs\n")) << result.out;
  EXPECT_NE(result.out.find("1 images are not paired"), std::string::npos) << result.out;

  const auto json = nlohmann::json::parse(readTextFile(out / "result.json"));
  EXPECT_EQ(json.at("pairs"), 2);
  EXPECT_EQ(json.at("unpaired"), 1);
  EXPECT_LT(json.at("measures").at("rmse_linear").at("mean").get<double>(), 0.006);
  const std::string csv = readTextFile(out / "measures.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_NE(readTextFile(out / "unpaired.csv").find(",1,CAMERA_0001.png,"), std::string::npos);
  EXPECT_FALSE(cv::imread((out / "contact_sheet.png").string()).empty());
  EXPECT_FALSE(cv::imread((out / "r_frames/000002_frame.jpg").string()).empty());
  EXPECT_NE(readTextFile(out / "report.html").find("data:image/jpeg;base64,"), std::string::npos);

  fs::rename(out, folder / "moved");  // what the rawlog names is beside it
  const std::string rawlog = (folder / "moved/r_pairs.rawlog").string();
  const auto info = test::runFathom("info " + test::shellQuoted(rawlog));
  EXPECT_EQ(info.status, 0) << info.err;
  if (test::runShell("command -v rawlog-edit").status != 0) GTEST_SKIP() << "needs rawlog-edit (mrpt-apps)";
  const auto stock = test::runShell("rawlog-edit --info -i " + test::shellQuoted(rawlog));
  EXPECT_EQ(stock.status, 0) << stock.err;
  for (const char* label : {"CAMERA", "SIMULATED", "MARKERS"})
    EXPECT_NE(stock.out.find(label), std::string::npos) << stock.out;
  const auto list =
      test::runShell("cd " + test::shellQuoted((folder / "moved").string()) +
                     " && rawlog-edit --list-images -i r_pairs.rawlog --text-file-output images.txt"
                     " && cat images.txt");
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_NE(list.out.find("000002_simulated.png"), std::string::npos) << list.out;
}

TEST(SilCommand, ARecordingWithoutAMarkerIsOneLine) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder, {.images = 2, .yaw_deg = 180});
  const auto result = runSilOn(recording, "--out " + test::shellQuoted((folder / "out").string()));
  test::expectBadInput(result, "none of its 2 images can be paired (2 times: no marker of a panel)");
  EXPECT_FALSE(fs::exists(folder / "out/report.html"));
}

TEST(SilCommand, BadInputIsOneLine) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder, {.images = 1});
  const std::string out = "--out " + test::shellQuoted((folder / "out").string());
  test::expectBadInput(runSilOn(recording, "--measure beauty " + out), "no such measure");
  test::expectBadInput(runSilOn(recording, "--calibration nowhere.yaml " + out), "nowhere.yaml");
  test::expectBadInput(test::runFathom("sil nowhere.rawlog " + out), "nowhere.rawlog");
  writeTextFile(folder / "r_simulation.json", "{");
  test::expectBadInput(runSilOn(recording, out), "r_simulation.json");
}

}  // namespace
}  // namespace fathom
