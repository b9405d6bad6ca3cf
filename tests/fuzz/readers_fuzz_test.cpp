// Every reader: files of tests/fuzz/corpus and of config/, damaged anywhere. A reader takes them or throws
// one Error of one line; nothing else, in memory that the file's own size justifies. FATHOM_FUZZ_SECONDS
// makes each reader's run as long as that (tests/fuzz/readers-for-long runs all of them).
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "batch/batch_plan.h"
#include "camera_tables/board_corners.h"
#include "core/error.h"
#include "core/files.h"
#include "effects/calibration.h"
#include "image_files/image_file.h"
#include "imaging/camera_files.h"
#include "imaging/water.h"
#include "landmarks/given_corners.h"
#include "landmarks/tie_points.h"
#include "panel/mesh.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "recording/tum.h"
#include "ros_bag/topic_map.h"
#include "sensors/vehicle.h"
#include "simulation/read_trajectory.h"
#include "sources/degradation.h"
#include "support/bags.h"
#include "support/damaged_text.h"
#include "support/memory.h"
#include "support/panels.h"
#include "support/shared_data.h"
#include "support/shipped.h"
#include "support/stopwatch.h"
#include "video/frame_stamps.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::peakMegabytes;

struct Reader {
  std::string name;
  std::vector<fs::path> corpus;
  std::function<void(const fs::path&)> read;
  std::vector<fs::path> beside = {};  ///< what it refers to
};
std::ostream& operator<<(std::ostream& out, const Reader& reader) { return out << reader.name; }

fs::path corpus(const std::string& file) { return test::kSource / "tests/fuzz/corpus" / file; }
fs::path config(const std::string& file) { return test::kConfig / file; }

/// Reads with whatever else has been read into a value that nobody looks at.
template <class Read>
std::function<void(const fs::path&)> reading(const Read& read) {
  return [read](const fs::path& file) { static_cast<void>(read(file)); };
}

/// To its end; what was lost of it is an error here.
void readRawlog(const fs::path& file) {
  RawlogReader reader(file);
  while (reader.next()) continue;
  if (const auto& loss = reader.loss())
    throw Error(file.string(), "byte " + std::to_string(loss->at_byte), loss->reason);
}

void readBag(const fs::path& file) {
  streamBag(file, test::topicMap({test::bagTopic("/imu", TopicRole::ins)}), [](Sample&&) {});
}

/// By the mesh that refers to it.
void readMaterials(const fs::path& file) {
  fs::rename(file, file.parent_path() / "board.mtl");
  readMesh(file.parent_path() / "board.obj");
}

std::vector<Reader> readers() {
  const Checkerboard board{3, 2, 0.03};
  return {
      {"rawlog", {corpus("every_kind.rawlog"), corpus("plain.rawlog")}, readRawlog},
      {"bag", {corpus("plain.bag"), corpus("bz2.bag"), corpus("lz4.bag")}, readBag},
      {"map", {corpus("board.yaml")}, reading(readPanelMap), {corpus("board.obj"), corpus("board.mtl")}},
      {"mesh",
       {corpus("board.obj")},
       reading([](const fs::path& file) { return readMesh(file); }),
       {corpus("board.mtl")}},
      {"materials", {corpus("board.mtl")}, readMaterials, {corpus("board.obj")}},
      {"image",
       {corpus("gray.png"), corpus("colour.png"), corpus("colour.jpg"), corpus("colour.bmp")},
       reading([](const fs::path& file) { return readImage(file); })},
      {"vehicle", {config("rov.yaml"), config("trial_rov.yaml")}, reading(readVehicle)},
      {"water", {config("water_turbid.yaml"), config("water_clear.yaml")}, reading(readEnvironment)},
      {"calibration", {corpus("calibration.yaml")}, reading([](const fs::path& f) {
         return readCalibration(f);
       })},
      {"trajectory",
       {config("dive_trajectory.yaml"), config("trajectory_station.yaml"), config("trajectory_survey.yaml")},
       reading([](const fs::path& file) { return readTrajectory(file); })},
      {"topics", {config("husky_topics.yaml")}, reading(readTopicMap)},
      {"faults",
       {config("degrade_poor_bus.yaml"), config("degrade_landmarks.yaml")},
       reading([](const fs::path& file) { return readDegradation(file); })},
      {"batch", {corpus("batch.yaml")}, reading(readBatchPlan)},
      {"camera",
       {corpus("opencv.yaml"), corpus("camera_info.yaml"), corpus("camchain.yaml")},
       reading([](const fs::path& file) { return readCameraFile(file); })},
      {"tum", {corpus("path.tum")}, reading(readTum)},
      {"corners", {corpus("corners.csv")}, reading([](const fs::path& file) {
         return readGivenCorners(file, file.parent_path());
       })},
      {"board corners", {corpus("board.csv")}, reading([board](const fs::path& file) {
         return readBoardCorners(file, board, 0.1);
       })},
      {"tie points", {corpus("points.csv")}, reading(readTiePoints)},
      {"frame stamps", {corpus("frame_stamps.csv"), corpus("iso_stamps.csv")}, reading(readFrameStamps)}};
}

/// Bytes may be anything in binary files, and lengths in them too.
std::string damagedBytes(std::string bytes, Random& random) {
  if (random.uniform() < 0.5 || bytes.size() < 8) return test::damaged(bytes, random);
  const std::string extreme[] = {std::string(4, '\xff'), std::string(4, '\0'), "\x7f\xff\xff\xff"};
  return bytes.replace(random.bits() % (bytes.size() - 4), 4, extreme[random.bits() % 3]);
}

class ReadersFuzz : public testing::TestWithParam<Reader> {
 protected:
  void SetUp() override {
    for (const fs::path& file : GetParam().beside) fs::copy_file(file, folder_ / file.filename());
  }

  /// What is complained of; empty: it was read.
  std::string complaintAbout(const std::string& bytes, const std::string& ending) const {
    const fs::path file = folder_ / ("damaged" + ending);
    test::writeNew(file, bytes);
    try {
      GetParam().read(file);
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_TRUE(std::none_of(line.begin(), line.end(), [](unsigned char c) {
        return std::iscntrl(c) != 0;
      })) << line;
      EXPECT_FALSE(error.why.empty());
      return error.what();
    }
    return {};
  }

  fs::path folder_ = test::scratchFolder();
};

TEST_P(ReadersFuzz, ReadsWhatIsWhole) {
  for (const fs::path& file : GetParam().corpus)
    EXPECT_EQ(complaintAbout(readTextFile(file), file.extension()), "") << file;
}

TEST_P(ReadersFuzz, DamageIsAnErrorOrNone) {
  const char* seconds = std::getenv("FATHOM_FUZZ_SECONDS");
  const double longest_s = seconds != nullptr ? std::atof(seconds) : 0;
  constexpr int kRuns = 400;
  constexpr double kMost_mb =
      1000;  // what a reader of files of some kilobytes may take; sanitizers keep freed memory
  Random random(41);
  const auto begin = std::chrono::steady_clock::now();
  const double before_mb = peakMegabytes();
  int refused = 0, runs = 0;
  for (; runs < kRuns || test::secondsSince(begin) < longest_s; ++runs) {
    const fs::path& file = GetParam().corpus[random.bits() % GetParam().corpus.size()];
    std::string bytes = readTextFile(file);
    for (auto wounds = 1 + random.bits() % 3; wounds > 0 && !bytes.empty(); --wounds)
      bytes = damagedBytes(bytes, random);
    refused += complaintAbout(bytes, file.extension()).empty() ? 0 : 1;
    if (HasFailure() || peakMegabytes() - before_mb > kMost_mb) {
      writeTextFile(folder_ / "culprit", bytes);
      FAIL() << "run " << runs << ", " << peakMegabytes() - before_mb << " MB, " << folder_ / "culprit";
    }
  }
  std::cout << runs << " damaged files, " << refused << " refused\n";
  EXPECT_GT(refused, runs / 20);
  EXPECT_LT(refused, runs);
}

INSTANTIATE_TEST_SUITE_P(Of, ReadersFuzz, testing::ValuesIn(readers()), [](const auto& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// Ten levels, each of ten of the one before: 10^9 items ("billion laughs").
std::string bomb() {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int level = 1; level < 10; ++level) {
    text += "a" + std::to_string(level) + ": &a" + std::to_string(level) + " [";
    for (int i = 0; i < 10; ++i) text += (i > 0 ? ", *a" : "*a") + std::to_string(level - 1);
    text += "]\n";
  }
  return text;
}

TEST_P(ReadersFuzz, ABombOfAliasesIsAnError) {
  if (GetParam().corpus[0].extension() != ".yaml") return;
  const double before_mb = peakMegabytes();
  for (const std::string& text :
       {bomb(), readTextFile(GetParam().corpus[0]) + bomb(), std::string(100000, '['),
        std::string(50000, '{'), "? " + std::string(20000, '-')})
    EXPECT_NE(complaintAbout(text, ".yaml"), "");
  EXPECT_LT(peakMegabytes() - before_mb, 1000);
}

}  // namespace
}  // namespace fathom
