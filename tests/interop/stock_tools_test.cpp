// Every kind of rawlog that fathom ships or writes, in MRPT's stock tools: rawlog-edit, and RawLogViewer and
// SceneViewer3D on a screen of their own.
#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>

#include "recording/rawlog.h"
#include "support/every_command.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {
namespace fs = std::filesystem;

/// A rawlog, and the command that writes it; none: it is shipped.
struct StockInput {
  std::string name;    ///< for gtest: letters only
  std::string file;    ///< below the command's results, or the project's folder
  std::string labels;  ///< as rawlog-edit lists them
};
std::ostream& operator<<(std::ostream& out, const StockInput& input) { return out << input.name; }

const StockInput kRawlogs[] = {
    {"dive", "rawlogs/dive/dive.rawlog", "DEPTH, DVL, DVL_BEAMS, INS, TRUTH"},
    {"trial", "rawlogs/trial/trial.rawlog", "CAMERA, DEPTH, DVL, DVL_BEAMS, INS, TRUTH"},
    {"sealed", "rawlogs/sealed/sealed.rawlog", "CAMERA, DEPTH, DVL, DVL_BEAMS, INS, TRUTH"},
    {"simulate", "Fahrt ü 1.rawlog", "CAMERA, DEPTH, DVL, DVL_BEAMS, INS, TRUTH"},
    {"localize", "Fahrt ü 1_results.rawlog", "EKF_TL2"},
    {"tasks", "Fahrt ü 1_results.rawlog", "EKF_TL5, EKF_TL5_IMPROVED, MARKERS, MARKER_SIGHTS, PANEL"},
    {"sil", "Fahrt ü 1_pairs.rawlog", "CAMERA, MARKERS, SIMULATED"},
    {"handles", "Fahrt ü 1_results.rawlog", "HANDLES, PANEL"},
    {"importbag", "Bandaufnahme ä.rawlog", "INS"},
    {"importcsv", "section1.rawlog", "DVL, INS"},
    {"importcorners", "Ecken é.rawlog", "CAMERA"},
    {"importtiepoints", "Punkte ä.rawlog", "STEREO"},
    {"importvideo", "Film ö.rawlog", "CAMERA"},
};
const StockInput kScenes[] = {{"map", "dexrov.3Dscene", ""}, {"tasks", "Fahrt ü 1_results.3Dscene", ""}};

/// A copy of what is shipped: the stock tools write beside what they read.
fs::path shippedCopy(const fs::path& file, const fs::path& folder) {
  const std::string images = file.stem().string() + "_Images";
  fs::create_directories(folder);
  fs::copy_file(file, folder / file.filename());
  if (fs::exists(file.parent_path() / images)) fs::copy(file.parent_path() / images, folder / images);
  return folder / file.filename();
}

/// Where it lies; its command has been run.
fs::path made(const StockInput& input, const fs::path& results) {
  if (input.file.starts_with("rawlogs/")) return shippedCopy(kSource / input.file, results);
  inputFolder();
  const auto done = run(writingCommand(input.name), results);
  EXPECT_EQ(done.status, 0) << done.err;
  return results / input.file;
}

bool isInstalled(const std::string& programs) {
  return runShell("for p in " + programs + "; do command -v $p || exit 1; done").status == 0;
}

/// In the recording's folder, as MRPT looks for images from there.
ProgramResult besideIt(const fs::path& file, const std::string& command) {
  return runShell("cd " + shellQuoted(file.parent_path().string()) + " && " + command);
}

class StockRawlog : public testing::TestWithParam<StockInput> {};

std::size_t entriesOf(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  std::size_t entries = 0;
  while (reader.next()) ++entries;
  EXPECT_FALSE(reader.loss());
  return entries;
}

std::size_t linesIn(const fs::path& file) {
  const std::string text = readTextFile(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_P(StockRawlog, RawlogEditListsAndExportsIt) {
  if (!isInstalled("rawlog-edit")) GTEST_SKIP() << "needs rawlog-edit (mrpt-apps)";
  const fs::path out = scratchFolder(), rawlog = made(GetParam(), out / "results");
  const std::size_t entries = entriesOf(rawlog);
  const auto edit = [&](const std::string& what) {
    const auto done =
        besideIt(rawlog, "rawlog-edit " + what + " -w -i " + shellQuoted(rawlog.filename().string()));
    EXPECT_EQ(done.status, 0) << what << ": " << done.out << done.err;
    return done.out;
  };
  const auto inOut = [&](const char* name) { return shellQuoted((out / name).string()); };
  const std::string info = edit("--info");
  EXPECT_NE(info.find("objects         : " + std::to_string(entries) + "\n"), std::string::npos) << info;
  EXPECT_NE(info.find("Observations format               : Yes"), std::string::npos) << info;
  EXPECT_NE(info.find(", " + GetParam().labels + "\n"), std::string::npos) << info;
  edit("--list-timestamps --text-file-output " + inOut("times.txt"));
  EXPECT_EQ(linesIn(out / "times.txt"), entries);
  edit("--export-txt");
  if (GetParam().labels.ends_with("INS") || GetParam().labels.ends_with("INS, TRUTH")) {
    EXPECT_GT(linesIn(rawlog.parent_path() / (rawlog.stem().string() + "_INS.txt")), 100U);
  }

  // What it cuts out is a recording again.
  const std::string label = GetParam().labels.substr(0, GetParam().labels.find(','));
  edit("--keep-label " + label + " -o " + inOut("kept.rawlog"));
  const auto kept = runFathom("info " + inOut("kept.rawlog"));
  EXPECT_EQ(kept.status, 0) << kept.err;
  EXPECT_NE(kept.out.find(label), std::string::npos) << kept.out;
}

/// A recording in MRPT's other format, by MRPT itself: what was done, then what was seen.
TEST(ActionsAndFrames, AreCountedAsMrptCountsThem) {
  using namespace mrpt::obs;
  CRawlog log;
  for (int i = 0; i < 50; ++i) {
    CActionCollection actions;
    actions.insert(CActionRobotMovement2D());
    log.insert(actions);
    CSensoryFrame frame;
    for (int seen = i % 4; seen > 0; --seen) {
      const auto odometry = std::make_shared<CObservationOdometry>();
      odometry->sensorLabel = "WHEELS";
      odometry->timestamp = mrpt::Clock::fromDouble(1.7e9 + i + 0.1 * seen);
      frame.insert(odometry);
    }
    log.insert(frame);
  }
  const fs::path file = scratchFolder() / "frames.rawlog";
  ASSERT_TRUE(log.saveToRawLogFile(file.string()));

  CRawlog back;
  ASSERT_TRUE(back.loadFromRawLogFile(file.string()));
  std::size_t actions = 0, observations = 0;
  for (std::size_t i = 0; i < back.size(); ++i) {
    actions += back.getType(i) == CRawlog::etActionCollection;
    if (back.getType(i) == CRawlog::etSensoryFrame) observations += back.getAsObservations(i)->size();
  }
  EXPECT_EQ(actions, 50U);
  EXPECT_EQ(observations, 73U);
  EXPECT_EQ(entriesOf(file), actions + observations);
  const auto info = runFathom("info " + shellQuoted(file.string()));
  EXPECT_NE(info.out.find("123 entries"), std::string::npos) << info.out;
}

constexpr int kLeastInk = 300;  // pixels of a few words

/// How many colours, coarsely, there are in a part of a picture.
std::size_t coloursIn(const cv::Mat& picture) {
  std::set<int> colours;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const auto& pixel = picture.at<cv::Vec3b>(y, x);
      colours.insert(pixel[0] / 16 * 256 + pixel[1] / 16 * 16 + pixel[2] / 16);
    }
  return colours.size();
}

/// Pixels that are dark, as text is.
int inkIn(const cv::Mat& picture) {
  cv::Mat gray;
  cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
  return cv::countNonZero(gray < 100);
}

/// Pixels that are not the gray on which the viewer lays pictures.
int unlikeBackground(const cv::Mat& picture) {
  cv::Mat background;
  cv::inRange(picture, cv::Scalar(100, 100, 100), cv::Scalar(104, 104, 104), background);
  return picture.rows * picture.cols - cv::countNonZero(background);
}

cv::Mat photographed(const std::string& script, const fs::path& file, const std::string& more) {
  const fs::path picture = file.parent_path() / (file.stem().string() + ".png");
  const auto done = runShell(shellQuoted((kSource / "tests/interop" / script).string()) + " " +
                             shellQuoted(file.string()) + " " + shellQuoted(picture.string()) + " " + more);
  EXPECT_EQ(done.status, 0) << done.out << done.err;
  return cv::imread(picture.string());
}

/// A copy under a name of ASCII letters, with its images: the viewers open no other.
fs::path plainlyNamed(const fs::path& file) {
  const fs::path folder = scratchFolder() / "plain", copy = folder / ("copy" + file.extension().string());
  fs::create_directories(folder);
  fs::copy_file(file, copy);
  const fs::path images = file.parent_path() / (file.stem().string() + "_Images");
  if (fs::exists(images)) fs::copy(images, folder / "copy_Images");
  return copy;
}

/// Which entry of those on the viewer's first page is an image.
std::optional<int> firstImageOf(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  int entry = 0;
  for (auto sample = reader.next(); sample && entry < 35; sample = reader.next()) {
    if (std::holds_alternative<ImageSample>(sample->reading)) return entry;
    if (!std::holds_alternative<RecordingHeader>(sample->reading)) ++entry;
  }
  return std::nullopt;
}

/// The lists of entries, below the first line, and the picture of the one selected.
const cv::Rect kEntries(10, 116, 280, 500), kPicture(420, 540, 960, 280);

TEST_P(StockRawlog, RawLogViewerShowsIt) {
  if (!isInstalled("RawLogViewer Xvfb xdotool import"))
    GTEST_SKIP() << "needs RawLogViewer (mrpt-apps), Xvfb, xdotool, ImageMagick";
  const fs::path results = fs::path(scratchFolder().string() + "-results");
  fs::remove_all(results);
  const fs::path rawlog = plainlyNamed(made(GetParam(), results));
  const auto image = firstImageOf(rawlog);
  const cv::Mat screen = photographed("screenshot-rawlogviewer", rawlog, std::to_string(image.value_or(1)));
  ASSERT_EQ(screen.size(), cv::Size(1400, 1000));
  EXPECT_GT(inkIn(screen(kEntries)), kLeastInk) << "no entries in the list";
  if (image) {
    EXPECT_GT(unlikeBackground(screen(kPicture)), 50'000) << "no picture of entry " << *image;
  }
}
INSTANTIATE_TEST_SUITE_P(Of, StockRawlog, testing::ValuesIn(kRawlogs),
                         [](const auto& info) { return info.param.name; });

// Whether the test above can tell.
TEST(StockViewer, ShowsNoEntriesWhereThereAreNone) {
  if (!isInstalled("RawLogViewer Xvfb xdotool import"))
    GTEST_SKIP() << "needs RawLogViewer (mrpt-apps), Xvfb, xdotool, ImageMagick";
  const fs::path file = fs::path(scratchFolder().string() + "-empty.rawlog");
  RawlogWriter(file, {}, fromUnixSeconds(1.7e9)).finish();
  const cv::Mat screen = photographed("screenshot-rawlogviewer", file, "");
  ASSERT_EQ(screen.size(), cv::Size(1400, 1000));
  EXPECT_LT(inkIn(screen(kEntries)), kLeastInk);
}

class StockScene : public testing::TestWithParam<StockInput> {};

TEST_P(StockScene, SceneViewerShowsIt) {
  if (!isInstalled("SceneViewer3D Xvfb xdotool import"))
    GTEST_SKIP() << "needs SceneViewer3D (mrpt-apps), Xvfb, xdotool, ImageMagick";
  const fs::path results = fs::path(scratchFolder().string() + "-results");
  fs::remove_all(results);
  const cv::Mat screen = photographed("screenshot-sceneviewer", plainlyNamed(made(GetParam(), results)), "");
  ASSERT_EQ(screen.size(), cv::Size(1400, 1000));
  EXPECT_GT(coloursIn(screen(cv::Rect(100, 200, 1200, 700))), 20U) << "nothing is drawn";
}
INSTANTIATE_TEST_SUITE_P(Of, StockScene, testing::ValuesIn(kScenes),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace fathom::test
