#include "recording/recording_info.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {

const LabelInfo& labelOf(const RecordingInfo& info, const std::string& label) {
  const auto found = std::find_if(info.labels.begin(), info.labels.end(),
                                  [&](const LabelInfo& entry) { return entry.label == label; });
  if (found == info.labels.end()) throw std::out_of_range(label);
  return *found;
}

bool mentions(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

class RecordingInfoTest : public testing::Test {
 protected:
  RecordingInfo inspected(const std::vector<Sample>& samples) {
    writeRecording(folder / "a.rawlog", samples);
    return inspectRecording(folder / "a.rawlog");
  }
  static Sample dvl(double seconds, double x = 1.0, const Pose& mounting = {}) {
    return {after(kStart, seconds), labels::kDvl, DvlSample{mounting, Vector3d(x, 0, 0)}};
  }
  std::filesystem::path folder = scratchFolder();
};

TEST_F(RecordingInfoTest, RatesAndJitter) {
  // Periods alternate between 0.19 and 0.21 s: 5 Hz with a standard deviation of 0.01 s.
  std::vector<Sample> samples;
  samples.reserve(101);
  for (int i = 0; i < 101; ++i) samples.push_back(dvl(0.2 * i + (i % 2 ? 0.01 : 0.0)));
  const RecordingInfo info = inspected(samples);
  const LabelInfo& label = labelOf(info, "DVL");
  EXPECT_EQ(label.kind, "DVL");
  EXPECT_EQ(label.count, 101U);
  EXPECT_NEAR(label.rate_hz, 5.0, 1e-9);
  EXPECT_NEAR(label.jitter_s, 0.01, 1e-6);
  EXPECT_TRUE(label.gaps.empty());
  EXPECT_EQ(info.entries, 102U);
  EXPECT_NEAR(info.duration_s, 20.0, 1e-9);
  EXPECT_EQ(info.header.vehicle, "rov.yaml");
  EXPECT_TRUE(remarks(info).empty());
}

TEST_F(RecordingInfoTest, GapsAndDuplicates) {
  std::vector<Sample> samples;
  for (int i = 0; i < 100; ++i) {
    if (i >= 40 && i < 44) continue;  // 1 s without
    samples.push_back(dvl(0.2 * i));
    if (i == 70) samples.push_back(dvl(0.2 * i));
  }
  const RecordingInfo info = inspected(samples);
  const LabelInfo& label = labelOf(info, "DVL");
  ASSERT_EQ(label.gaps.size(), 1U);
  EXPECT_EQ(label.gaps[0].begin, after(kStart, 0.2 * 39));
  EXPECT_NEAR(label.gaps[0].seconds, 1.0, 1e-7);
  EXPECT_EQ(label.duplicates, 1U);
  EXPECT_NEAR(label.median_period_s, 0.2, 1e-7);
  EXPECT_NEAR(label.jitter_s, 0.0, 1e-7);  // gaps are no jitter
  EXPECT_TRUE(mentions(remarks(info), "1 gaps, the longest 1.000 s at 7.800 s"));
  EXPECT_TRUE(mentions(remarks(info), "1 entry at the same time"));
}

TEST_F(RecordingInfoTest, TimeGoingBack) {
  // The writer refuses this, so two recordings are laid one after the other.
  writeRecording(folder / "late.rawlog", {dvl(10.0), dvl(10.2)});
  writeRecording(folder / "early.rawlog", {dvl(5.0), dvl(5.2)});
  const std::string late = inflated(folder / "late.rawlog"), early = inflated(folder / "early.rawlog");
  const auto first_entry = early.find("mrpt::obs::CObservationIMU") - 1;
  writeTextFile(folder / "a.rawlog", late + early.substr(first_entry));
  const RecordingInfo info = inspectRecording(folder / "a.rawlog");
  EXPECT_EQ(labelOf(info, "DVL").steps_back, 1U);
  EXPECT_EQ(info.steps_back, 1U);
  EXPECT_EQ(labelOf(info, "DVL").first_time, after(kStart, 5.0));
  EXPECT_EQ(labelOf(info, "DVL").last_time, after(kStart, 10.2));
  EXPECT_TRUE(mentions(remarks(info), "DVL: 1 entry earlier than the one before"));
}

TEST_F(RecordingInfoTest, BadAndAbsentValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Sample unlocked = dvl(0.3);
  std::get<DvlSample>(unlocked.reading).velocity_dvl.reset();
  const RecordingInfo info =
      inspected({dvl(0.0),
                 dvl(0.1, nan),
                 dvl(0.2, 1.0 / 0.0),
                 unlocked,
                 {after(kStart, 0.4), labels::kIns, InsSample{{}, Vector3d::Zero(), {}, {}}}});
  EXPECT_EQ(labelOf(info, "DVL").not_finite, 2U);
  EXPECT_EQ(labelOf(info, "DVL").absent.at("bottom lock"), 1U);
  EXPECT_EQ(labelOf(info, "INS").absent.at("specific force"), 1U);
  EXPECT_EQ(labelOf(info, "INS").absent.count("angular velocity"), 0U);
  EXPECT_TRUE(mentions(remarks(info), "DVL: 2 entries with a NaN or infinite value"));
}

TEST_F(RecordingInfoTest, MountingsAndCameras) {
  Random random(51);
  const Pose mounting = randomPose(random);
  Pose moved = mounting;
  moved.position.x() += 0.01;
  Sample image = randomSample(6, after(kStart, 1.0), random);
  Sample other = image;
  other.time = after(kStart, 2.0);
  std::get<ImageSample>(other.reading).intrinsics.model.fx_px = 123.0;
  std::get<ImageSample>(other.reading).file = "there.png";
  std::filesystem::create_directories(folder / "a_Images");
  writeTextFile(folder / "a_Images" / "there.png", "");
  const RecordingInfo info =
      inspected({dvl(0.0, 1, mounting), dvl(0.2, 1, mounting), dvl(0.4, 1, moved), image, other});
  const LabelInfo& dvl_info = labelOf(info, "DVL");
  EXPECT_EQ(dvl_info.mounting_changes, 1U);
  EXPECT_EQ(dvl_info.mountings.at(0).position, mounting.position);
  const LabelInfo& camera = labelOf(info, "CAMERA");
  EXPECT_EQ(camera.mounting_changes, 0U);
  EXPECT_EQ(camera.intrinsics_changes, 1U);
  EXPECT_EQ(camera.missing_images, std::vector<std::string>{std::get<ImageSample>(image.reading).file});
  EXPECT_EQ(remarks(info).size(), 3U);
}

TEST_F(RecordingInfoTest, JsonAndTextSayTheSame) {
  Random random(52);
  writeRecording(folder / "whole.rawlog", randomSamples(400, random));
  const std::string plain = inflated(folder / "whole.rawlog");
  writeTextFile(folder / "cut.rawlog", plain.substr(0, plain.size() - 10));
  const RecordingInfo info = inspectRecording(folder / "cut.rawlog");
  ASSERT_TRUE(info.loss);
  const nlohmann::json json = toJson(info);
  EXPECT_EQ(json["entries"], 400);  // 399 and the header
  EXPECT_EQ(json["loss"]["lost_bytes"], info.loss->lost_bytes);
  EXPECT_EQ(json["labels"].size(), 1U + kKinds);
  for (const auto& label : json["labels"])
    EXPECT_NE(describe(info).find(label["kind"].get<std::string>()), std::string::npos);
  for (const std::string remark : json["remarks"]) EXPECT_NE(describe(info).find(remark), std::string::npos);
  EXPECT_TRUE(mentions(remarks(info), "reading stopped at byte"));
}

TEST_F(RecordingInfoTest, SharedSample) {
  FATHOM_NEEDS_SHARED("data/sample/none");
  const RecordingInfo info = inspectRecording(sharedData("data/sample/none/recording.rawlog"));
  EXPECT_EQ(info.entries, 20762U);
  EXPECT_NEAR(info.duration_s, 180.0, 1e-6);
  EXPECT_NEAR(labelOf(info, "INS").rate_hz, 100.0, 1e-6);
  EXPECT_NEAR(labelOf(info, "DVL").rate_hz, 5.0, 1e-6);
  EXPECT_EQ(labelOf(info, "DVL_BEAMS").mountings.size(), 4U);
  EXPECT_EQ(labelOf(info, "CAMERA").intrinsics.at(0).model.width_px, 640);
  EXPECT_EQ(info.header.panel_map, "panel/panel.yaml");
  EXPECT_TRUE(remarks(info).empty());
}

}  // namespace
}  // namespace fathom::test
