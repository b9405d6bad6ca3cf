#include "recording/rawlog.h"

#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <fstream>
#include <map>

#include "core/error.h"
#include "support/recordings.h"
#include "support/shared_data.h"
#include "support/small_disk.h"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;
using namespace mrpt::obs;

void expectNear(const Pose& a, const Pose& b, double tolerance) {
  EXPECT_LT((a.position - b.position).norm(), tolerance);
  EXPECT_LT((a.rotation - b.rotation).norm(), tolerance);
}

template <class T>
const T& as(const Sample& sample) {
  return std::get<T>(sample.reading);
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

/// A plain rawlog of MRPT's own making.
fs::path writePlain(const std::vector<const mrpt::serialization::CSerializable*>& objects,
                    const std::string& tail = {}) {
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  for (const auto* object : objects) archive << *object;
  auto file = scratchFolder() / "plain.rawlog";
  writeTextFile(
      file,
      std::string(static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()) + tail);
  return file;
}

std::string rawlogErrorOf(const fs::path& file) {
  try {
    readRecording(file);
  } catch (const Error& error) {
    return error.where + ": " + error.why;
  }
  return "no error";
}

CObservationIMU imuLabelled(const std::string& label, double seconds = 0.0) {
  CObservationIMU imu;
  imu.sensorLabel = label;
  imu.timestamp = after(kStart, seconds);
  return imu;
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
    expectNear(Pose::fromMrpt(back.T_odom_robot.mean), Pose::fromMrpt(pose.T_odom_robot.mean), 1e-300);
    EXPECT_EQ(back.T_odom_robot.cov.asEigen(), pose.T_odom_robot.cov.asEigen());
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

TEST(Rawlog, MarkersOfOthersShareTheirSigmas) {
  CObservationBearingRange bearing;
  bearing.sensorLabel = "MARKER_SIGHTS";
  bearing.timestamp = kStart;
  bearing.sensor_std_range = 0.5F;
  bearing.sensor_std_yaw = 0.25F;
  bearing.sensor_std_pitch = 0.125F;
  bearing.sensedData.resize(1);
  const ReadBack back = readRecording(writePlain({&bearing}));
  const Matrix3d expected = Vector3d(0.25, 0.0625, 0.015625).asDiagonal();
  EXPECT_EQ(as<MarkersSample>(back.samples.at(0)).markers.at(0).covariance, expected);
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

// ---- what the convention does not know, or forbids ----

TEST(Rawlog, FilesThatAreNone) {
  const auto folder = scratchFolder();
  EXPECT_EQ(rawlogErrorOf(folder / "missing.rawlog"), ": no such file");
  EXPECT_EQ(rawlogErrorOf(folder), ": is not a file");
  writeTextFile(folder / "empty.rawlog", "");
  EXPECT_EQ(rawlogErrorOf(folder / "empty.rawlog"), ": is empty");
  writeTextFile(folder / "text.rawlog", "a,b,c\n1,2,3\n");
  EXPECT_EQ(rawlogErrorOf(folder / "text.rawlog"),
            ": is no rawlog, or damaged from the start: no object begins where one should");
  writeTextFile(folder / "gzip.rawlog", "\x1f\x8b and then nonsense");
  EXPECT_NE(rawlogErrorOf(folder / "gzip.rawlog").find("gzip data are damaged"), std::string::npos);
}

TEST(Rawlog, WrongClassIsNamedWithItsByte) {
  const CObservationIMU first = imuLabelled("DVL");
  CObservationRange range;
  range.timestamp = kStart;
  range.sensorLabel = "INS";
  const auto file = writePlain({&first, &range});
  mrpt::io::CMemoryStream stream;
  mrpt::serialization::archiveFrom(stream) << first;
  EXPECT_EQ(rawlogErrorOf(file), "byte " + std::to_string(stream.getTotalBytesCount()) +
                                     ": an entry labelled INS is a mrpt::obs::CObservationRange, must be a "
                                     "mrpt::obs::CObservationIMU");
}

TEST(Rawlog, DepthNeedsPressure) {
  const CObservationIMU depth = imuLabelled("DEPTH");
  EXPECT_EQ(rawlogErrorOf(writePlain({&depth})), "byte 0: a DEPTH entry lacks IMU_PRESSURE");
}

TEST(Rawlog, ImagesMustBeFiles) {
  CObservationImage image;
  image.timestamp = kStart;
  image.sensorLabel = "CAMERA";
  image.image = mrpt::img::CImage(40, 30, mrpt::img::CH_RGB);
  EXPECT_NE(rawlogErrorOf(writePlain({&image})).find("byte 0: an image is stored in the rawlog"),
            std::string::npos);
  image.sensorLabel = "HANDYCAM";  // no business of the convention
  const ReadBack back = readRecording(writePlain({&image}));
  ASSERT_EQ(back.samples.size(), 1U);
  EXPECT_EQ(as<UnknownSample>(back.samples[0]).mrpt_class, "mrpt::obs::CObservationImage");
}

TEST(Rawlog, ActionsAndFramesAreRefused) {
  const CSensoryFrame frame;
  EXPECT_EQ(rawlogErrorOf(writePlain({&frame})),
            "byte 0: holds a mrpt::obs::CSensoryFrame: not in the observations-only format");
}

TEST(Rawlog, UnknownEntriesArePassedOver) {
  const CObservationIMU ins = imuLabelled("INS", 1.0), other = imuLabelled("XSENS", 2.0),
                        last = imuLabelled("DVL", 4.0);
  CObservationComment remark;
  remark.text = "[recording]\nvehicle = another\n";
  remark.timestamp = after(kStart, 3.0);
  CObservationOdometry odometry;
  odometry.sensorLabel = "WHEELS";
  CObservationBearingRange bearing;
  bearing.sensorLabel = "MARKERS";
  bearing.timestamp = after(kStart, 3.0);
  const ReadBack back = readRecording(writePlain({&ins, &other, &odometry, &remark, &bearing, &last}));
  EXPECT_FALSE(back.loss);
  ASSERT_EQ(back.samples.size(), 6U);
  EXPECT_TRUE(std::holds_alternative<InsSample>(back.samples[0].reading));
  EXPECT_EQ(back.samples[1].label, "XSENS");
  EXPECT_EQ(as<UnknownSample>(back.samples[1]).mrpt_class, "mrpt::obs::CObservationIMU");
  EXPECT_EQ(as<UnknownSample>(back.samples[2]).mrpt_class, "mrpt::obs::CObservationOdometry");
  EXPECT_EQ(back.samples[2].time, after(kStart, 2.0));
  EXPECT_EQ(as<UnknownSample>(back.samples[3]).mrpt_class, "mrpt::obs::CObservationComment");
  EXPECT_EQ(back.samples[4].label, "MARKERS");
  EXPECT_TRUE(std::holds_alternative<DvlSample>(back.samples[5].reading));
}

TEST(Rawlog, BadAttitudeIsNan) {
  CObservationIMU ins = imuLabelled("INS");
  for (const auto field : {IMU_ORI_QUAT_X, IMU_ORI_QUAT_Y, IMU_ORI_QUAT_Z, IMU_ORI_QUAT_W})
    ins.set(field, 0.0);
  const ReadBack back = readRecording(writePlain({&ins}));
  const auto& sample = as<InsSample>(back.samples.at(0));
  ASSERT_TRUE(sample.R_odom_ins);
  EXPECT_TRUE(sample.R_odom_ins->hasNaN());
}

// ---- loss ----

class RawlogLoss : public testing::Test {
 protected:
  void SetUp() override {
    folder = scratchFolder();
    Random random(6);
    samples = randomSamples(3000, random);  // 30 s
    writeRecording(folder / "gzip.rawlog", samples);
    gzip = readTextFile(folder / "gzip.rawlog");
    plain = inflated(folder / "gzip.rawlog");
    writeTextFile(folder / "plain.rawlog", plain);
    all = fingerprints(readRecording(folder / "plain.rawlog").samples);
  }
  ReadBack read(const std::string& bytes) {
    writeTextFile(folder / "damaged.rawlog", bytes);
    return readRecording(folder / "damaged.rawlog");
  }
  void expectPrefix(const ReadBack& back, std::size_t at_least, std::size_t at_most) {
    EXPECT_GE(back.samples.size(), at_least);
    EXPECT_LE(back.samples.size(), at_most);
    for (std::size_t i = 0; i < back.samples.size(); ++i)
      ASSERT_EQ(fingerprint(back.samples[i]), all[i]) << i;
  }

  fs::path folder;
  std::vector<Sample> samples;
  std::vector<std::string> all;
  std::string gzip, plain;
};

TEST_F(RawlogLoss, PlainAndGzipAreTheSame) {
  EXPECT_EQ(all.size(), 3000U);
  EXPECT_EQ(fingerprints(readRecording(folder / "gzip.rawlog").samples), all);
  EXPECT_GT(plain.size(), std::size_t{1} << 20);  // more than one of the writer's blocks
}

TEST_F(RawlogLoss, PlainCutWithinAnEntry) {
  const auto last = plain.rfind("mrpt::obs::CObservation") - 1;
  const ReadBack back = read(plain.substr(0, last + 100));
  expectPrefix(back, 2999, 2999);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->at_byte, last);
  EXPECT_EQ(back.loss->lost_bytes, 100U);
  EXPECT_TRUE(back.loss->estimated);
  EXPECT_LT(back.loss->lost_seconds, 0.1);
  EXPECT_EQ(back.loss->reason, "the data end inside an entry");
}

TEST_F(RawlogLoss, PlainDamageKnowsTheSecondsLost) {
  const auto at = plain.find("mrpt::obs::CObservationIMU", plain.size() / 3) - 1;
  std::string bytes = plain;
  bytes[at + 5] = '\xff';
  const ReadBack back = read(bytes);
  expectPrefix(back, 900, 1100);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->at_byte, at);
  EXPECT_EQ(back.loss->lost_bytes, plain.size() - at);
  EXPECT_FALSE(back.loss->estimated);
  EXPECT_NEAR(back.loss->lost_seconds, secondsBetween(back.samples.back().time, samples.back().time), 1e-9);
  EXPECT_NE(describe(*back.loss).find("are lost"), std::string::npos);
}

TEST_F(RawlogLoss, GzipCut) {
  const ReadBack back = read(gzip.substr(0, gzip.size() / 2));
  expectPrefix(back, 1300, 1700);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->at_byte + back.loss->lost_bytes, gzip.size() / 2);
  EXPECT_GT(back.loss->lost_bytes, 0U);
  EXPECT_LT(back.loss->lost_bytes, 2000U);  // a part of one entry
  EXPECT_NE(back.loss->reason.find("cut short"), std::string::npos);
}

TEST_F(RawlogLoss, GzipDamageHandsOnNothingWrong) {
  std::string bytes = gzip;
  bytes[gzip.size() / 2] = static_cast<char>(bytes[gzip.size() / 2] ^ 0x10);
  const ReadBack back = read(bytes);
  expectPrefix(back, 800, 1600);  // up to the end of the block before: 256 KiB are some 500 entries
  ASSERT_TRUE(back.loss);
  EXPECT_TRUE(back.loss->estimated);
  EXPECT_LE(back.loss->at_byte, gzip.size() / 2);
  const double lost_s = secondsBetween(back.samples.back().time, samples.back().time);
  EXPECT_NEAR(back.loss->lost_seconds, lost_s, 0.1 * lost_s);  // the entries are much alike
}

TEST_F(RawlogLoss, GzipChecksum) {
  // One member, as MRPT writes it: all entries come, the checksum shows that some may be wrong.
  const auto file = folder / "one.rawlog";
  const gzFile out = gzopen(file.c_str(), "wb6");
  gzwrite(out, plain.data(), static_cast<unsigned>(plain.size()));
  gzclose(out);
  std::string bytes = readTextFile(file);
  EXPECT_FALSE(read(bytes).loss);
  bytes[bytes.size() - 6] ^= 1;
  const ReadBack back = read(bytes);
  expectPrefix(back, 3000, 3000);
  ASSERT_TRUE(back.loss);
  EXPECT_NE(back.loss->reason.find("incorrect data check"), std::string::npos);
  EXPECT_GT(back.loss->lost_bytes, 0U);
}

TEST_F(RawlogLoss, TrailingBytes) {
  for (const std::string& whole : {gzip, plain}) {
    const ReadBack back = read(whole + "trailing");
    expectPrefix(back, 3000, 3000);
    ASSERT_TRUE(back.loss);
    EXPECT_EQ(back.loss->at_byte, whole.size());
    EXPECT_EQ(back.loss->lost_bytes, 8U);
  }
}

// ---- recordings made by others ----

TEST(Rawlog, SharedSamplesAreReadWhole) {
  FATHOM_NEEDS_SHARED("data/sample");
  int recordings = 0;
  for (const auto& entry : fs::directory_iterator(sharedData("data/sample"))) {
    SCOPED_TRACE(entry.path());
    std::map<std::string, int> counts;
    const ReadBack back = readRecording(entry.path() / "recording.rawlog");
    for (const Sample& sample : back.samples) ++counts[sample.label];
    // As `rawlog-edit --info` counts them.
    const std::map<std::string, int> expected{
        {"CAMERA", 60}, {"DEPTH", 900}, {"DVL", 900}, {"DVL_BEAMS", 900}, {"INS", 18001}};
    EXPECT_EQ(counts, expected);
    EXPECT_FALSE(back.loss);
    ++recordings;
  }
  EXPECT_GT(recordings, 0);
}

// ---- memory ----

std::size_t peakMemoryKilobytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmHWM:") continue;
    std::size_t kilobytes = 0;
    status >> kilobytes;
    return kilobytes;
  }
  return 0;
}

TEST(Rawlog, MemoryDoesNotGrowWithLength) {
#ifdef FATHOM_SANITIZE
  GTEST_SKIP() << "the address sanitizer keeps freed memory";
#endif
  const auto file = scratchFolder() / "long.rawlog";
  const std::size_t before_kb = peakMemoryKilobytes();
  ASSERT_GT(before_kb, 0U);
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
  EXPECT_LT(peakMemoryKilobytes() - before_kb, 16'000U);  // blocks and buffers: a few MB
}

}  // namespace
}  // namespace fathom::test
