#include "recording/rawlog.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "support/memory.h"
#include "support/recordings.h"
#include "support/sanitized.h"
#include "support/shared_data.h"
#include "support/small_disk.h"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;

void expectNear(const Pose& a, const Pose& b, double tolerance) {
  EXPECT_LT((a.position - b.position).norm(), tolerance);
  EXPECT_LT((a.rotation - b.rotation).norm(), tolerance);
}

/// Writes one sample, reads it back.
Sample throughFile(const Sample& sample) {
  const auto file = scratchFolder() / "one.rawlog";
  writeRecording(file, {sample});
  const ReadBack back = readRecording(file);
  EXPECT_EQ(back.samples.size(), 1U);
  EXPECT_FALSE(back.loss);
  EXPECT_EQ(back.samples.at(0).label, sample.label);
  EXPECT_EQ(back.samples.at(0).time, sample.time);
  return back.samples.at(0);
}

// ---- what is written is read again ----

TEST(Rawlog, InsRoundTrip) {
  Random random(1);
  InsSample ins{randomPose(random), Vector3d(0.1, -0.2, 0.3), Vector3d(0.5, 0.25, 9.81),
                randomPose(random).rotation};
  const auto back = as<InsSample>(throughFile({kStart, labels::kIns, ins}));
  expectNear(back.T_robot_ins, ins.T_robot_ins, 1e-300);  // a matrix in MRPT: exact
  EXPECT_EQ(*back.angular_velocity_ins, *ins.angular_velocity_ins);
  EXPECT_EQ(*back.specific_force_ins, *ins.specific_force_ins);
  EXPECT_LT((*back.R_odom_ins - *ins.R_odom_ins).norm(), 1e-14);  // by way of a quaternion

  const auto bare = as<InsSample>(throughFile({kStart, labels::kIns, InsSample{}}));
  EXPECT_FALSE(bare.angular_velocity_ins || bare.specific_force_ins || bare.R_odom_ins);
}

TEST(Rawlog, DvlRoundTrip) {
  const DvlSample dvl{{}, Vector3d(0.0, 0.0, 0.0)};  // zero is a velocity, not an absence
  EXPECT_EQ(*as<DvlSample>(throughFile({kStart, labels::kDvl, dvl})).velocity_dvl, *dvl.velocity_dvl);
  EXPECT_FALSE(as<DvlSample>(throughFile({kStart, labels::kDvl, DvlSample{}})).velocity_dvl);
}

TEST(Rawlog, BeamsRoundTrip) {
  Random random(2);
  DvlBeamsSample beams{{{randomPose(random), 12.5}, {randomPose(random), {}}, {randomPose(random), 3.7}}};
  const auto back = as<DvlBeamsSample>(throughFile({kStart, labels::kDvlBeams, beams})).beams;
  ASSERT_EQ(back.size(), 3U);
  EXPECT_DOUBLE_EQ(*back[0].range_m, 12.5);
  EXPECT_FALSE(back[1].range_m);
  EXPECT_NEAR(*back[2].range_m, 3.7, 3.7 * 0x1p-24);  // MRPT keeps ranges as float
  for (std::size_t k = 0; k < 3; ++k)                 // and beam poses as angles
    expectNear(back[k].T_robot_beam, beams.beams[k].T_robot_beam, 1e-14);
  EXPECT_TRUE(as<DvlBeamsSample>(throughFile({kStart, labels::kDvlBeams, DvlBeamsSample{}})).beams.empty());
}

TEST(Rawlog, DepthRoundTrip) {
  const auto warm = as<DepthSample>(throughFile({kStart, labels::kDepth, DepthSample{{}, 123456.7, 11.5}}));
  EXPECT_EQ(warm.pressure_pa, 123456.7);
  EXPECT_EQ(*warm.temperature_celsius, 11.5);
  EXPECT_FALSE(
      as<DepthSample>(throughFile({kStart, labels::kDepth, DepthSample{{}, 1e5, {}}})).temperature_celsius);
}

TEST(Rawlog, PoseRoundTrip) {
  Random random(3);
  for (const char* label : {labels::kUsbl, labels::kTruth, "EKF_TL2", "MARKERS"}) {
    Sample sample = randomSample(4, kStart, random);
    sample.label = label;
    const auto& pose = as<PoseSample>(sample);
    const Sample read = throughFile(sample);
    const auto& back = as<PoseSample>(read);
    expectNear(back.T_odom_robot.mean, pose.T_odom_robot.mean, 1e-300);
    EXPECT_EQ(back.T_odom_robot.covariance, pose.T_odom_robot.covariance);
    expectNear(back.T_robot_sensor, pose.T_robot_sensor, 1e-300);
  }
}

TEST(Rawlog, ImagesRoundTrip) {
  Random random(4);
  const Sample image = randomSample(6, kStart, random);
  const Sample image_back = throughFile(image);
  EXPECT_EQ(as<ImageSample>(image_back).file, as<ImageSample>(image).file);
  EXPECT_TRUE(as<ImageSample>(image_back).intrinsics == as<ImageSample>(image).intrinsics);
  expectNear(as<ImageSample>(image_back).T_robot_camera, as<ImageSample>(image).T_robot_camera, 1e-300);

  const Sample stereo = randomSample(7, kStart, random);
  const Sample stereo_back = throughFile(stereo);
  const auto& a = as<StereoSample>(stereo_back);
  const auto& b = as<StereoSample>(stereo);
  EXPECT_EQ(a.left_file, b.left_file);
  EXPECT_EQ(a.right_file, b.right_file);
  EXPECT_TRUE(a.left_intrinsics == b.left_intrinsics && a.right_intrinsics == b.right_intrinsics);
  expectNear(a.T_robot_left, b.T_robot_left, 1e-14);  // quaternions in MRPT
  expectNear(a.T_left_right, b.T_left_right, 1e-14);
}

TEST(Rawlog, PanelsRoundTrip) {
  Random random(8);
  const Sample sample = randomSample(8, kStart, random);
  const auto& panels = as<PanelSample>(sample);
  const Sample read = throughFile(sample);
  const auto& back = as<PanelSample>(read);
  expectNear(back.T_robot_camera, panels.T_robot_camera, 1e-300);
  ASSERT_EQ(back.panels.size(), panels.panels.size());
  for (std::size_t k = 0; k < back.panels.size(); ++k) {
    EXPECT_EQ(back.panels[k].panel, panels.panels[k].panel);
    const UncertainPose &a = back.panels[k].T_camera_panel, &b = panels.panels[k].T_camera_panel;
    expectNear(a.pose, b.pose, 1e-300);
    EXPECT_TRUE(a.covariance.isApprox(b.covariance, 1e-8));  // stored as its inverse, in angles
  }
}

TEST(Rawlog, PanelWithoutCovarianceHasNone) {
  PanelSample panels;
  panels.panels.resize(1);
  const auto back = as<PanelSample>(throughFile({kStart, labels::kPanel, panels}));
  ASSERT_EQ(back.panels.size(), 1U);
  EXPECT_TRUE(back.panels[0].T_camera_panel.covariance.array().isNaN().all());
  const Sample nothing{kStart, labels::kPanel, PanelSample{}};
  EXPECT_TRUE(as<PanelSample>(throughFile(nothing)).panels.empty());
}

TEST(Rawlog, MarkersRoundTrip) {
  Random random(9);
  const Sample sample = randomSample(9, kStart, random);
  const auto& markers = as<MarkersSample>(sample);
  const Sample read = throughFile(sample);
  const auto& back = as<MarkersSample>(read);
  expectNear(back.T_robot_camera_forward, markers.T_robot_camera_forward, 1e-300);
  ASSERT_EQ(back.markers.size(), markers.markers.size());
  for (std::size_t k = 0; k < back.markers.size(); ++k) {
    const SeenMarker &a = back.markers[k], &b = markers.markers[k];
    EXPECT_EQ(a.id, b.id);
    EXPECT_NEAR(a.range_m, b.range_m, b.range_m * 0x1p-24);  // floats in MRPT
    EXPECT_NEAR(a.yaw_rad, b.yaw_rad, std::abs(b.yaw_rad) * 0x1p-24);
    EXPECT_NEAR(a.pitch_rad, b.pitch_rad, std::abs(b.pitch_rad) * 0x1p-24);
    EXPECT_EQ(a.covariance, b.covariance);
  }
}

TEST(Rawlog, OfTwoMarkersOfOneIdTheSecondHasNone) {
  MarkersSample markers;
  markers.markers = {{7, 1, 0, 0}, {7, 2, 0, 0}, {7, 3, 0, 0}};
  const auto back = as<MarkersSample>(throughFile({kStart, labels::kMarkerSights, markers})).markers;
  ASSERT_EQ(back.size(), 3U);
  EXPECT_EQ(back[0].id, 7);
  EXPECT_EQ(back[1].id, -1);
  EXPECT_EQ(back[2].id, -1);
}

TEST(Rawlog, NanIsHandedOn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto back = as<DvlSample>(throughFile({kStart, labels::kDvl, DvlSample{{}, Vector3d(1, nan, 3)}}));
  ASSERT_TRUE(back.velocity_dvl);
  EXPECT_TRUE(std::isnan(back.velocity_dvl->y()));
  EXPECT_EQ(back.velocity_dvl->x(), 1.0);
}

TEST(Rawlog, HeaderOfSeveralLines) {
  const RecordingHeader header{"maps/a b/panel.yaml", "C:\\new\\rov.yaml",
                               "first line\nsecond = line\n[third] // line; # \\n as it is $env{HOME}"};
  const auto file = scratchFolder() / "header.rawlog";
  writeRecording(file, {}, header);
  RawlogReader reader(file);
  EXPECT_EQ(reader.header().panel_map, header.panel_map);
  EXPECT_EQ(reader.header().vehicle, header.vehicle);
  EXPECT_EQ(reader.header().description, header.description);
  const auto first = reader.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->time, kStart);
  EXPECT_EQ(as<RecordingHeader>(*first).description, header.description);
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.loss());
  EXPECT_EQ(reader.imageFolder(), file.parent_path() / "header_Images");
}

// ---- the writer ----

TEST(Rawlog, SameSamplesGiveSameBytes) {
  const auto folder = scratchFolder();
  Random random(5);
  const auto samples = randomSamples(2000, random);
  writeRecording(folder / "a.rawlog", samples);
  writeRecording(folder / "b.rawlog", samples);
  const std::string bytes = readTextFile(folder / "a.rawlog");
  EXPECT_EQ(bytes, readTextFile(folder / "b.rawlog"));
  EXPECT_EQ(bytes.substr(4, 4), std::string(4, '\0'));  // RFC 1952: no modification time
}

TEST(Rawlog, WriterLeavesNothingHalf) {
  const auto folder = scratchFolder();
  {
    RawlogWriter writer(folder / "half.rawlog", {}, kStart);
    writer.write({kStart, labels::kDvl, DvlSample{}});
  }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST(Rawlog, WriterNamesWhatItCannotWrite) {
  const auto folder = scratchFolder();
  writeTextFile(folder / "file", "");
  EXPECT_THROW(RawlogWriter(folder / "file" / "a.rawlog", {}, kStart), Error);
  fs::create_symlink(folder / "file", folder / "linked.rawlog.part");
  EXPECT_THROW(RawlogWriter(folder / "linked.rawlog", {}, kStart), Error) << "what is elsewhere";
  EXPECT_EQ(readTextFile(folder / "file"), "");
  RawlogWriter writer(folder / "full.rawlog", {}, kStart);
  const test::SmallDisk disk(10);
  EXPECT_THROW(writer.finish(), Error);
  EXPECT_FALSE(fs::exists(folder / "full.rawlog"));
}

TEST(Rawlog, WriterRefusesWhatTheConventionDoesNot) {
  RawlogWriter writer(scratchFolder() / "a.rawlog", {}, kStart);
  writer.write({after(kStart, 1.0), labels::kDvl, DvlSample{}});
  writer.write({after(kStart, 1.0), labels::kDvl, DvlSample{}});
  EXPECT_THROW(writer.write({after(kStart, 0.9), labels::kDvl, DvlSample{}}), std::logic_error);
  EXPECT_THROW(writer.write({after(kStart, 2.0), labels::kIns, DvlSample{}}), std::logic_error);
  EXPECT_THROW(writer.write({after(kStart, 2.0), labels::kIns, PoseSample{}}), std::logic_error);
  EXPECT_THROW(writer.write({after(kStart, 2.0), labels::kPanel, PoseSample{}}), std::logic_error);
  EXPECT_THROW(writer.write({after(kStart, 2.0), labels::kMarkers, PanelSample{}}), std::logic_error);
  EXPECT_THROW(writer.write({after(kStart, 2.0), "X", UnknownSample{}}), std::logic_error);
  EXPECT_THROW(writer.write({after(kStart, 2.0), "", RecordingHeader{}}), std::logic_error);
}

// ---- memory ----

TEST(Rawlog, MemoryDoesNotGrowWithLength) {
  if (test::kSanitized) GTEST_SKIP() << "the address sanitizer keeps freed memory";
  const auto file = scratchFolder() / "long.rawlog";
  const double before_mb = peakMegabytes();
  ASSERT_GT(before_mb, 0);
  constexpr int kEntries = 30 * 60 * 100;  // 30 min at 100 Hz: 80 MB of objects
  {
    Random random(7);
    RawlogWriter writer(file, {}, kStart);
    for (int i = 0; i < kEntries; ++i)
      writer.write(
          {after(kStart, 0.01 * i), labels::kIns, InsSample{{}, random.normal3(), random.normal3(), {}}});
    writer.finish();
  }
  RawlogReader reader(file);
  int entries = 0;
  while (reader.next()) ++entries;
  EXPECT_EQ(entries, kEntries + 1);
  EXPECT_FALSE(reader.loss());
  EXPECT_LT(peakMegabytes() - before_mb, 15.6);  // blocks and buffers: a few MB
}

}  // namespace
}  // namespace fathom::test
