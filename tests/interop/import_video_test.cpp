// A video and the navigation of the same dive, from their files to a recording that other commands read.
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "image_files/image_file.h"
#include "support/folder_contents.h"
#include "support/recordings.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "support/small_vehicle.h"
#include "support/videos.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::shellQuoted;

constexpr int kVideoFrames = 60;

class ImportVideoCommand : public testing::Test {
 protected:
  ImportVideoCommand() {
    test::writeVideo(folder_ / "dive.mp4", "avc1", kVideoFrames);
    test::writeSmallVehicle(folder_);
    writeStamps(kVideoFrames);
  }

  /// Of 2023-11-14 22:13:20 UTC, which is test::kStart, and on; frame 30 is late by two intervals.
  void writeStamps(int rows) {
    std::string text = "frame,stamp\n";
    for (int k = 0; k < rows; ++k) {
      const double t_s = 20 + 0.04 * k + (k >= 30 ? 0.08 : 0);
      text += print("%d,2023-11-14T22:13:%09.6fZ\n", k, t_s);
    }
    writeTextFile(folder_ / "stamps.csv", text);
  }

  std::string in(const std::string& name) const { return shellQuoted((folder_ / name).string()); }
  std::string arguments(const std::string& more = "") const {
    return "import video " + in("dive.mp4") + " --stamps " + in("stamps.csv") + " --vehicle " +
           in("vehicle.yaml") + " --out " + in("out") + more;
  }
  /// INS, DVL and pressure by turns, of 3 s from test::kStart on.
  void writeNavigation() const {
    std::vector<Sample> samples;
    Random random(5);
    for (int i = 0; i < 300; ++i)
      samples.push_back(test::randomSample(std::array{0, 1, 3}[static_cast<std::size_t>(i % 3)],
                                           after(test::kStart, 0.01 * i), random));
    test::writeRecording(folder_ / "navigation.rawlog", samples);
  }

  fs::path folder_ = test::scratchFolder();
};

TEST_F(ImportVideoCommand, JoinsNavigationAndSaysWhatItFound) {
  writeNavigation();
  const auto made = runFathom(arguments(" --every 10 --grey --recording " + in("navigation.rawlog")));
  ASSERT_EQ(made.status, 0) << made.err;
  for (const char* part : {"remark: video: codec avc1, 320 x 240 px, 25 frames a second", "ISO 8601",
                           "counted from 0", "about 2 frames were dropped", "wrote "})
    EXPECT_NE(made.out.find(part), std::string::npos) << part << "\n" << made.out;

  const auto json = nlohmann::json::parse(readTextFile(folder_ / "out/dive_import.json"));
  EXPECT_EQ(json.at("samples"), 300 + kVideoFrames / 10);
  EXPECT_GE(json.at("remarks").size(), 5U);
  EXPECT_EQ(json.at("description"), "video dive.mp4 with navigation.rawlog");
  EXPECT_EQ(readTextFile(folder_ / "out/dive_vehicle.yaml"), readTextFile(folder_ / "vehicle.yaml"));

  RawlogReader reader(folder_ / "out/dive.rawlog");
  EXPECT_EQ(reader.header().vehicle, "dive_vehicle.yaml");
  EXPECT_EQ(reader.header().panel_map, "../maps/panel.yaml") << "of navigation.rawlog, seen from out/";
  int frame = 0;
  while (const auto sample = reader.next()) {
    const auto* image = std::get_if<ImageSample>(&sample->reading);
    if (!image) continue;
    const cv::Mat pixels = readImage(reader.imageFolder() / image->file);
    EXPECT_EQ(pixels.type(), CV_8UC1);
    // ISO text has 1 us here.
    EXPECT_NEAR(secondsBetween(test::kStart, sample->time), 0.04 * frame + (frame >= 30 ? 0.08 : 0), 1e-6);
    frame += 10;
  }
  EXPECT_EQ(frame, kVideoFrames);
  const auto info = runFathom("info --json " + in("out/dive.rawlog"));
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out).at("entries"), 301 + kVideoFrames / 10);

  const std::string rawlog = readTextFile(folder_ / "out/dive.rawlog");
  test::expectBadInput(runFathom(arguments(" --recording " + in("out/dive.rawlog"))),
                       "would be written over");
  EXPECT_EQ(readTextFile(folder_ / "out/dive.rawlog"), rawlog);
}

TEST_F(ImportVideoCommand, WrongInputIsOneLineAndWritesNothing) {
  const auto expect = [&](const std::string& more, const std::string& part) {
    test::expectBadInput(runFathom(arguments(more)), part);
    EXPECT_TRUE(test::contentsOf(folder_ / "out").empty()) << part;
  };
  expect(" --every 0", "--every");
  expect(" --from 100", "--from");
  expect(" --recording /no/such.rawlog", "/no/such.rawlog");
  writeStamps(kVideoFrames + 1);
  expect("", "stamps.csv: line 62: is of frame 60, counted from 0; the video has only 60 frames");
  writeTextFile(folder_ / "stamps.csv", "1700000000\n1700000001\n1700000000.5\n");
  expect("", "stamps.csv: line 3: its stamp steps back by 0.5 s");
  writeTextFile(folder_ / "stamps.csv", "1700000000\n1700000001\n");
  expect("", "stamps.csv: line 2: is the last, of frame 1; the video goes on (60 frames by its header)");
  writeStamps(kVideoFrames);
  fs::copy_file(test::kRov, folder_ / "vehicle.yaml", fs::copy_options::overwrite_existing);
  expect("", "dive.mp4: its frames are of 320 x 240 px, the camera of vehicle.yaml of 640 x 480");
  writeTextFile(folder_ / "vehicle.yaml", "gravity_m_s2: 9.80665\n");
  expect("", "vehicle.yaml: camera: missing");
  test::writeSmallVehicle(folder_);
  std::string damaged = readTextFile(folder_ / "dive.mp4");
  for (std::size_t at = damaged.size() / 2; at < damaged.size() / 2 + 400; ++at)
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
  writeTextFile(folder_ / "dive.mp4", damaged);
  expect("", "cut off or damaged");
}

TEST_F(ImportVideoCommand, InterruptedLeavesNoFile) {
  constexpr int kMany = 1000;
  test::writeVideo(folder_ / "long.avi", "MJPG", kMany);
  std::string stamps;
  for (int k = 0; k < kMany; ++k) stamps += print("%.2f\n", 1'700'000'000 + 0.04 * k);
  writeTextFile(folder_ / "long.csv", stamps);
  const auto result = test::runShell(
      shellQuoted(test::fathomProgram()) + " import video " + in("long.avi") + " --stamps " + in("long.csv") +
      " --vehicle " + in("vehicle.yaml") + " --out " + in("out") + " & pid=$!; until ls " + in("out") +
      "/*/*.part >/dev/null 2>&1 || ! kill -0 $pid; do sleep 0.05; done; kill -INT $pid; wait $pid");
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_TRUE(test::contentsOf(folder_ / "out").empty());
}

}  // namespace
}  // namespace fathom
