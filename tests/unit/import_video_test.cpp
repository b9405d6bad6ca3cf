// Videos whose frames are known, written by OpenCV: each frame comes with its own stamp, or nothing comes.
#include "video/import_video.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "image_files/image_file.h"
#include "support/folder_contents.h"
#include "support/recordings.h"
#include "support/shared_data.h"
#include "support/small_vehicle.h"
#include "support/videos.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

constexpr int kVideoFrames = 40;
// A lossy codec leaves 33 dB or more of these frames at OpenCV's rates; of two different frames there are 25
// at most (videos.h).
constexpr double kSameFrame_db = 30;

/// Of frame k: irregular, as recorders' are.
double stampOf(int k) { return 0.04 * k + 0.003 * std::sin(2.0 * k); }
Time timeOf(int k) { return after(test::kStart, stampOf(k)); }

class ImportVideo : public testing::Test {
 protected:
  struct Result {
    ImportedRecording recording;
    std::vector<Sample> samples;

    std::vector<const Sample*> frames() const {
      std::vector<const Sample*> found;
      for (const Sample& sample : samples)
        if (std::holds_alternative<ImageSample>(sample.reading)) found.push_back(&sample);
      return found;
    }
    std::string remarks() const {
      std::string all;
      for (const std::string& line : recording.remarks) all += line + "\n";
      return all;
    }
  };

  ImportVideo() {
    source_.video = folder_ / "dive.avi";
    source_.stamps = folder_ / "stamps.csv";
    source_.vehicle = test::writeSmallVehicle(folder_);
    writeStamps(kVideoFrames);
  }

  void writeStamps(int rows) {
    std::string text = "stamp\n";
    for (int k = 0; k < rows; ++k) text += print("%.7f\n", 1'700'000'000.0 + stampOf(k));
    writeTextFile(source_.stamps, text);
  }

  Result imported() {
    Result result;
    result.recording =
        streamVideo(source_, images_, [&](Sample&& sample) { result.samples.push_back(std::move(sample)); });
    return result;
  }

  /// The message; and that the folder of images is as it was.
  std::string complaint() {
    const auto before = test::contentsOf(images_);
    try {
      imported();
    } catch (const Error& e) {
      EXPECT_EQ(test::contentsOf(images_), before) << e.what();
      return e.what();
    }
    return "";
  }

  cv::Mat imageOf(const Sample& sample) const {
    return readImage(images_ / std::get<ImageSample>(sample.reading).file);
  }

  /// What video frame k is, at k's time.
  void expectFrame(const Sample& sample, int k) const {
    // Stamps go to the table with 0.1 us, by a double that resolves 0.24 us.
    EXPECT_NEAR(secondsBetween(timeOf(k), sample.time), 0, 3e-7) << k;
    EXPECT_EQ(sample.label, "CAMERA");
    EXPECT_GT(cv::PSNR(imageOf(sample), test::videoFrame(k)), kSameFrame_db) << k;
  }

  fs::path folder_ = test::scratchFolder(), images_ = folder_ / "out_Images";
  VideoImport source_;
};

class ImportVideoOf : public ImportVideo,
                      public testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(ImportVideoOf, EachFrameHasItsStamp) {
  const auto [codec, ending] = GetParam();
  source_.video = folder_ / (std::string("dive") + ending);
  test::writeVideo(source_.video, codec, kVideoFrames);
  const Result result = imported();
  ASSERT_EQ(result.samples.size(), static_cast<std::size_t>(kVideoFrames));
  for (int k = 0; k < kVideoFrames; ++k) expectFrame(result.samples[static_cast<std::size_t>(k)], k);
  EXPECT_LT(cv::PSNR(test::videoFrame(7), test::videoFrame(8)), 25) << "frames are told apart";

  const Vehicle vehicle = readVehicle(source_.vehicle);
  const auto& image = std::get<ImageSample>(result.samples[0].reading);
  EXPECT_EQ(image.intrinsics.model, vehicle.camera->model);
  EXPECT_EQ(image.T_robot_camera.position, vehicle.camera->T_robot_camera.position);
  EXPECT_EQ(result.recording.vehicle_yaml, readTextFile(source_.vehicle));
  EXPECT_NE(result.remarks().find(print("25 frames a second by its header; %d frames, of which %d",
                                        kVideoFrames, kVideoFrames)),
            std::string::npos)
      << result.remarks();
  EXPECT_NE(result.remarks().find("Unix time in seconds"), std::string::npos) << result.remarks();
  EXPECT_NE(result.remarks().find("`processed` is right"), std::string::npos)
      << "rov.yaml has a linear camera";
}
INSTANTIATE_TEST_SUITE_P(Codecs, ImportVideoOf,
                         testing::Values(std::pair("MJPG", ".avi"), std::pair("mp4v", ".mp4"),
                                         std::pair("avc1", ".mp4")),
                         [](const auto& codec) { return std::string(codec.param.first); });

TEST_F(ImportVideo, OnlyWhatIsAskedFor) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  source_.every = 7;
  source_.grey = true;
  source_.from_s = 0.19;
  source_.to_s = 1.01;
  std::vector<int> expected;  // by the definition of each option
  for (int k = 0, wanted = 0; k < kVideoFrames; ++k)
    if (stampOf(k) >= 0.19 && stampOf(k) <= 1.01 && wanted++ % 7 == 0) expected.push_back(k);
  ASSERT_GE(expected.size(), 3U);
  const Result result = imported();
  ASSERT_EQ(result.samples.size(), expected.size());
  EXPECT_EQ(test::contentsOf(images_).size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const cv::Mat image = imageOf(result.samples[i]);
    ASSERT_EQ(image.type(), CV_8UC1);
    cv::Mat truth(image.size(), CV_8UC1);  // ITU-R BT.601
    const cv::Mat colours = test::videoFrame(expected[i]);
    for (int v = 0; v < truth.rows; ++v)
      for (int u = 0; u < truth.cols; ++u) {
        const auto& c = colours.at<cv::Vec3b>(v, u);
        truth.at<uchar>(v, u) = cv::saturate_cast<uchar>(0.114 * c[0] + 0.587 * c[1] + 0.299 * c[2]);
      }
    EXPECT_GT(cv::PSNR(image, truth), kSameFrame_db) << expected[i];
  }
  source_.from_s = 100;
  source_.to_s.reset();
  EXPECT_NE(complaint().find("--from"), std::string::npos);
}

TEST_F(ImportVideo, FramesWithoutRowAreLeftOut) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  std::string text = "frame,stamp\n";
  std::vector<int> with_row;
  for (int k = 2; k < kVideoFrames; k += 1 + k % 3) {
    with_row.push_back(k);
    text += print("%d,%.7f\n", k, 1'700'000'000.0 + stampOf(k));
  }
  writeTextFile(source_.stamps, text);
  const Result result = imported();
  ASSERT_EQ(result.samples.size(), with_row.size());
  for (std::size_t i = 0; i < with_row.size(); ++i) expectFrame(result.samples[i], with_row[i]);
  EXPECT_NE(result.remarks().find(print("%zu of the video's frames have no stamp",
                                        static_cast<std::size_t>(kVideoFrames) - with_row.size())),
            std::string::npos)
      << result.remarks();
  writeTextFile(source_.stamps, text + "40,1700000009\n");
  EXPECT_NE(complaint().find("is of frame 40, counted from 0; the video has only 40 frames"),
            std::string::npos);
}

TEST_F(ImportVideo, AsManyStampsAsFrames) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  writeStamps(kVideoFrames - 1);
  EXPECT_NE(complaint().find("stamps.csv: line 40: is the last, of frame 38; the video goes on"),
            std::string::npos)
      << complaint();
  writeStamps(kVideoFrames + 1);
  EXPECT_NE(complaint().find("stamps.csv: line 42: is of frame 40"), std::string::npos) << complaint();
}

// A track's header in MP4 has the matrix of its display (ISO 14496-12, 8.3.2): here a quarter of a turn.
TEST_F(ImportVideo, RotationForPlayersIsNotApplied) {
  source_.video = folder_ / "dive.mp4";
  test::writeVideo(source_.video, "avc1", kVideoFrames);
  std::string bytes = readTextFile(source_.video);
  const auto header = bytes.find("tkhd");
  ASSERT_NE(header, std::string::npos);
  constexpr std::size_t kBeforeMatrix = 4 + 40;
  const std::string one("\0\1\0\0", 4), minus_one("\xff\xff\0\0", 4), zero(4, '\0');
  bytes.replace(header + kBeforeMatrix, 20, zero + one + zero + minus_one + zero);
  writeTextFile(source_.video, bytes);
  const Result result = imported();
  ASSERT_EQ(result.samples.size(), static_cast<std::size_t>(kVideoFrames));
  expectFrame(result.samples[5], 5);
  EXPECT_NE(result.remarks().find("asks players to turn frames"), std::string::npos) << result.remarks();
}

TEST_F(ImportVideo, AnotherSizeThanTheCamera) {
  test::writeVideo(source_.video, "MJPG", 3);
  source_.vehicle = fs::path(FATHOM_SOURCE_DIR) / "config/rov.yaml";
  EXPECT_NE(complaint().find("its frames are of 320 x 240 px, the camera of rov.yaml of 640 x 480"),
            std::string::npos)
      << complaint();
}

// What was there before stays, also where the damage is behind many frames.
TEST_F(ImportVideo, CutOrDamagedIsRefusedWithTheFrame) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  imported();
  const std::string whole = readTextFile(source_.video);
  std::string damaged = whole;
  for (std::size_t at = whole.size() / 2; at < whole.size() / 2 + 400; ++at)
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
  // Frames of about the same size: the middle of the file is that of the video. A decoder works ahead by its
  // threads.
  for (const auto& [bytes, at_share] :
       {std::pair(whole.substr(0, whole.size() * 6 / 10), 0.6), {damaged, 0.5}}) {
    writeTextFile(source_.video, bytes);
    const std::string message = complaint();
    const auto where = message.find("dive.avi: frame ");
    ASSERT_NE(where, std::string::npos) << message;
    EXPECT_NEAR(std::stoi(message.substr(where + 16)), at_share * kVideoFrames, 6) << message;
    EXPECT_NE(message.find("cut off"), std::string::npos) << message;
  }
  source_.video = folder_ / "dive.mp4";
  test::writeVideo(source_.video, "avc1", kVideoFrames);
  const std::string mp4 = readTextFile(source_.video);
  writeTextFile(source_.video, mp4.substr(0, mp4.size() / 2));
  EXPECT_NE(complaint().find("dive.mp4: no video that can be decoded, or cut off"), std::string::npos);
  writeTextFile(source_.video, "no video at all");
  EXPECT_NE(complaint().find("no video"), std::string::npos);
  source_.video = folder_ / "missing.mp4";
  EXPECT_NE(complaint().find("cannot be read"), std::string::npos);
}

TEST_F(ImportVideo, ImagesOfAnEarlierImportAreRemoved) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  imported();
  writeTextFile(images_ / "mine.png", "mine");
  writeTextFile(images_ / "CAMERA_000003.png.part", "left by a run that was killed");
  source_.every = 10;
  imported();
  std::vector<std::string> names;
  for (const auto& [name, bytes] : test::contentsOf(images_)) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"CAMERA_000000.png", "CAMERA_000010.png", "CAMERA_000020.png",
                                             "CAMERA_000030.png", "mine.png"}));
}

class JoinedVideo : public ImportVideo {
 protected:
  /// INS, DVL and pressure by turns, 70 a second, from a second before the video on.
  std::vector<Sample> navigation(double begin_s = -1) {
    Random random(3);
    std::vector<Sample> samples;
    for (int i = 0; i < 250; ++i)
      samples.push_back(test::randomSample(std::array{0, 1, 3}[static_cast<std::size_t>(i % 3)],
                                           after(test::kStart, begin_s + i / 70.0), random));
    return samples;
  }
  void join(const std::vector<Sample>& samples) {
    source_.recording = folder_ / "navigation.rawlog";
    RawlogWriter writer(source_.recording, {"maps/panel.yaml", "rov.yaml", "a test"}, samples.front().time);
    for (const Sample& sample : samples) writer.write(sample);
    writer.finish();
  }
};

TEST_F(JoinedVideo, IsInOrderOfTimeAndNothingIsLost) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  join(navigation());
  source_.from_s = 0.5;
  const Result result = imported();
  EXPECT_TRUE(std::is_sorted(result.samples.begin(), result.samples.end(),
                             [](const Sample& a, const Sample& b) { return a.time < b.time; }));
  std::vector<Sample> others;
  for (const Sample& sample : result.samples)
    if (!std::holds_alternative<ImageSample>(sample.reading)) others.push_back(sample);
  EXPECT_EQ(test::fingerprints(others), test::fingerprints(test::readRecording(source_.recording).samples));
  const auto frames = result.frames();
  int late = 0;
  for (int k = 0; k < kVideoFrames; ++k) late += stampOf(k) >= 0.5 ? 1 : 0;
  ASSERT_EQ(std::ssize(frames), late);
  for (std::size_t i = 0; i < frames.size(); ++i)
    expectFrame(*frames[i], kVideoFrames - late + static_cast<int>(i));
  const RecordingHeader header = headerOf(source_, folder_ / "a/b");
  EXPECT_EQ(header.panel_map, "../../maps/panel.yaml");
  EXPECT_EQ(header.description, "video dive.avi with navigation.rawlog");
}

TEST_F(JoinedVideo, RecordingOfAnotherDiveIsRefused) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  join(navigation(3600));
  EXPECT_NE(complaint().find("navigation.rawlog: begins after the frames"), std::string::npos) << complaint();
  join(navigation(-3600));
  EXPECT_NE(complaint().find("navigation.rawlog: ends before the frames"), std::string::npos) << complaint();
}

TEST_F(JoinedVideo, RecordingWithImagesIsRefused) {
  test::writeVideo(source_.video, "MJPG", kVideoFrames);
  std::vector<Sample> samples = navigation();
  Random random(1);
  samples[100] = test::randomSample(6, samples[100].time, random);
  join(samples);
  EXPECT_NE(complaint().find("(CAMERA): has images"), std::string::npos) << complaint();
}

}  // namespace
}  // namespace fathom
