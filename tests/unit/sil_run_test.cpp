// Runs of the simulation in the loop: what they leave, and what becomes of what went wrong.
#include "sil/sil_run.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include <opencv2/videoio.hpp>

#include "core/error.h"
#include "sil/pair_video.h"
#include "support/shared_data.h"
#include "support/sil_recordings.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

SilResults runOn(const RecordingFiles& recording, const fs::path& out, SilOptions options = {}) {
  options.detection = test::silDetection();
  const PairMaker maker(test::silWorld(), options.pairs, options.detection);
  const PosedImages images =
      posedImages(recording.rawlog, {}, readPanelMaps(test::kDexrovMap), options.detection);
  return runSil(images, maker, options, {recording.rawlog, out, "r", {}});
}

SilOptions onlyRmse() {
  SilOptions options;
  options.measures = {"rmse-linear"};
  return options;
}

/// Every file below a folder, with its bytes.
std::map<std::string, std::string> treeOf(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).string()] = readTextFile(entry.path());
  return files;
}

void expectSameTree(const fs::path& a, const fs::path& b) {
  const auto files_a = treeOf(a), files_b = treeOf(b);
  for (const auto& [name, bytes] : files_a) {
    ASSERT_TRUE(files_b.contains(name)) << name;
    EXPECT_TRUE(files_b.at(name) == bytes) << name;
  }
  EXPECT_EQ(files_a.size(), files_b.size());
}

double valueOf(const SilResults& results, std::size_t pair, const std::string& column) {
  for (std::size_t i = 0; i < results.columns.size(); ++i)
    if (results.columns[i].name == column) return results.pairs.at(pair).record.values.at(i).value();
  ADD_FAILURE() << "no column " << column;
  return 0;
}

TEST(SilRun, MeasuresARecordingOfItsOwnWorldAsAlike) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder);
  const SilResults results = runOn(recording, folder / "out");
  ASSERT_EQ(results.pairs.size(), 3U);
  EXPECT_TRUE(results.unpaired.empty());
  for (std::size_t i = 0; i < 3; ++i) {
    // Noise of two images of 0.1 to 0.3 of full scale, 30000 electrons at full scale, and rounding: sigma of
    // the difference 0.003 to 0.005. The markers' pose is off by less than 0.1 px, which adds at edges only.
    EXPECT_LT(valueOf(results, i, "rmse_linear"), 0.006);
    EXPECT_GT(valueOf(results, i, "rmse_linear"), 0.002);
    EXPECT_GT(valueOf(results, i, "fsim"), 0.95);
    EXPECT_GT(valueOf(results, i, "detection_agreement_agreement"), 0.8);
  }

  RawlogReader rawlog(folder / "out/r_pairs.rawlog");
  std::vector<std::string> labels;
  std::vector<std::string> files;
  while (const auto sample = rawlog.next()) {
    labels.push_back(sample->label);
    if (const auto* image = std::get_if<ImageSample>(&sample->reading)) {
      files.push_back(image->file);
      EXPECT_TRUE(fs::exists(rawlog.imageFolder() / image->file)) << image->file;
      EXPECT_EQ(image->intrinsics.model.width_px, 320);
    }
  }
  ASSERT_EQ(labels.size(), 10U);  // the header first
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(labels[1 + 3 * i], labels::kCamera);
    EXPECT_EQ(labels[2 + 3 * i], labels::kSimulated);
    EXPECT_EQ(labels[3 + 3 * i], labels::kMarkers);
  }
  EXPECT_EQ(readTextFile(rawlog.imageFolder() / files[2]),
            readTextFile(recording.images / "CAMERA_0001.png"));

  cv::VideoCapture video((folder / "out/r_pairs.avi").string());
  EXPECT_EQ(static_cast<int>(video.get(cv::CAP_PROP_FRAME_COUNT)), 3);
  EXPECT_EQ(static_cast<int>(video.get(cv::CAP_PROP_FRAME_WIDTH)), 3 * 400);
}

TEST(SilRun, AVideoTakesThePlaceOfNoDevice) {
  const auto folder = test::scratchFolder();
  ASSERT_EQ(mkfifo((folder / "a.avi").c_str(), 0600), 0);
  {
    PairVideo video(folder / "a.avi");
    video.write(cv::Mat(64, 64, CV_8UC3, cv::Scalar(1, 2, 3)));
    EXPECT_THROW(video.finish(), Error);
  }
  EXPECT_TRUE(fs::is_fifo(folder / "a.avi"));
  EXPECT_FALSE(fs::exists(folder / "a.part.avi") || fs::exists(folder / "a.avi.part"));
}

TEST(SilRun, LeavesTheSameBytesHoweverOftenItWasCutShortAndOnHoweverManyThreads) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder);
  SilOptions options;
  options.frames = true;
  EXPECT_EQ(runOn(recording, folder / "whole", options).taken_over, 0U);
  EXPECT_EQ(runOn(recording, folder / "whole", options).taken_over, 3U);

  fs::copy(folder / "whole", folder / "cut", fs::copy_options::recursive);
  fs::remove(folder / "cut/r_pairs.rawlog");
  fs::remove(folder / "cut/r_pairs.avi");
  fs::remove(folder / "cut/chunks/chunk_000000.txt");
  fs::resize_file(folder / "cut/r_pairs_Images/000001_simulated.png", 1000);
  fs::remove(folder / "cut/r_frames/000002_frame.jpg");
  for (const char* part : {"cut/r_pairs.rawlog.part", "cut/r_pairs_Images/000002_panel.png.part",
                           "cut/chunks/chunk_000002.part", "cut/r_frames/000001_frame.jpg.part"})
    writeTextFile(folder / part, "half of");
  EXPECT_EQ(runOn(recording, folder / "cut", options).taken_over, 1U);
  expectSameTree(folder / "whole", folder / "cut");

  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  runOn(recording, folder / "one", options);
  expectSameTree(folder / "whole", folder / "one");
}

TEST(SilRun, TakesOverOnlyWhatOtherOptionsWouldMakeToo) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder);
  SilOptions few = onlyRmse();
  few.every = 2;
  few.frames = true;
  EXPECT_EQ(runOn(recording, folder / "out", few).pairs.size(), 2U);
  SilOptions all = few;
  all.every = 1;
  all.frames = false;
  EXPECT_EQ(runOn(recording, folder / "out", all).taken_over, 2U);
  EXPECT_FALSE(fs::exists(folder / "out/r_frames/000000_frame.jpg"));  // of a run that had them
  all.pairs.seed = 2;
  EXPECT_EQ(runOn(recording, folder / "out", all).taken_over, 0U);
  runOn(recording, folder / "out", few);
  EXPECT_FALSE(fs::exists(folder / "out/r_pairs_Images/000001_simulated.png"));  // not among the pairs
}

TEST(SilRun, ABadImageIsReportedAndDoesNotStopTheRest) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder);
  fs::resize_file(recording.images / "CAMERA_0001.png", 5000);
  const SilResults results = runOn(recording, folder / "out", onlyRmse());
  EXPECT_EQ(results.pairs.size(), 2U);
  ASSERT_EQ(results.unpaired.size(), 1U);
  EXPECT_EQ(results.unpaired[0].file.filename(), "CAMERA_0001.png");
  EXPECT_NE(results.unpaired[0].why, "");
  EXPECT_EQ(results.unpaired[0].number, 1U);
}

TEST(SilRun, PosesOfOtherImagesAreReported) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder);
  SilOptions options = onlyRmse();
  options.detection = test::silDetection();
  PairOptions strict;
  strict.largest_offset_px = 2;
  const PairMaker maker(test::silWorld(), strict, options.detection);
  PosedImages images = posedImages(recording.rawlog, {}, readPanelMaps(test::kDexrovMap), options.detection);
  ASSERT_EQ(images.posed.size(), 3U);
  std::swap(images.posed[0].T_odom_robot, images.posed[2].T_odom_robot);
  const SilResults results = runSil(images, maker, options, {recording.rawlog, folder / "out", "r", {}});
  EXPECT_EQ(results.pairs.size(), 1U);
  ASSERT_EQ(results.unpaired.size(), 2U);
  EXPECT_EQ(results.unpaired[0].why.find("the pose is not this image's: its markers lie "), 0U);
}

TEST(SilRun, AnUnknownMeasureIsRefused) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateForSil(folder, {.images = 1});
  SilOptions options;
  options.measures = {"beauty"};
  EXPECT_THROW(runOn(recording, folder / "out", options), Error);
}

}  // namespace
}  // namespace fathom
