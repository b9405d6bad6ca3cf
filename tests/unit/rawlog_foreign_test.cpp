// Rawlogs that others wrote: what the convention does not know, or forbids.
#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/serialization/CArchive.h>

#include <map>

#include "core/error.h"
#include "recording/export_csv.h"
#include "recording/mrpt_types.h"
#include "recording/rawlog.h"
#include "recording/recording_info.h"
#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;
using namespace mrpt::obs;

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
  imu.timestamp = toMrpt(after(kStart, seconds));
  return imu;
}

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

TEST(Rawlog, WhatHasNoTableIsNamed) {
  const CObservationIMU named = imuLabelled("a\x1b[31m"), ours = imuLabelled("INS");
  CObservationOdometry odometry;
  odometry.timestamp = toMrpt(kStart);
  const fs::path file = writePlain({&named, &odometry, &odometry, &ours});
  const CsvExport result = exportCsv(file, file.parent_path() / "tables");
  EXPECT_EQ(result.files.size(), 1U);
  EXPECT_EQ(result.left_out,
            (std::map<std::string, std::uint64_t>{{"a\\x1b[31m, mrpt::obs::CObservationIMU", 1},
                                                  {"mrpt::obs::CObservationOdometry", 2}}));
}

TEST(Rawlog, LabelsDoNotReachATerminalAsTheyAre) {
  const CObservationIMU first = imuLabelled("a\x1b[31m\nb"), second = first;
  const RecordingInfo info = inspectRecording(writePlain({&first, &second}));
  EXPECT_EQ(info.labels.at(0).label, "a\x1b[31m\nb");
  const std::string text = describe(info);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_NE(text.find("  a\\x1b[31m\\nb "), std::string::npos) << text;
  EXPECT_NE(text.find("  ! a\\x1b[31m\\nb: 1 entry at the same time"), std::string::npos) << text;
}

TEST(Rawlog, WrongClassIsNamedWithItsByte) {
  const CObservationIMU first = imuLabelled("DVL");
  CObservationRange range;
  range.timestamp = toMrpt(kStart);
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
  image.timestamp = toMrpt(kStart);
  image.sensorLabel = "CAMERA";
  image.image = mrpt::img::CImage(40, 30, mrpt::img::CH_RGB);
  EXPECT_NE(rawlogErrorOf(writePlain({&image})).find("byte 0: an image is stored in the rawlog"),
            std::string::npos);
  image.sensorLabel = "HANDYCAM";  // no business of the convention
  const ReadBack back = readRecording(writePlain({&image}));
  ASSERT_EQ(back.samples.size(), 1U);
  EXPECT_EQ(as<UnknownSample>(back.samples[0]).mrpt_class, "mrpt::obs::CObservationImage");
}

TEST(Rawlog, FramesAreTakenApart) {
  const CObservationIMU ins = imuLabelled("INS", 1.0), dvl = imuLabelled("DVL", 1.5),
                        next = imuLabelled("INS", 2.0);
  CSensoryFrame first, second, none;
  for (const CObservationIMU* entry : {&ins, &dvl}) first.insert(std::make_shared<CObservationIMU>(*entry));
  second.insert(std::make_shared<CObservationIMU>(next));
  CActionRobotMovement2D moved;
  moved.timestamp = toMrpt(after(kStart, 1.7));
  CActionCollection action;
  action.insert(moved);
  const ReadBack back = readRecording(writePlain({&action, &first, &none, &action, &second}));
  EXPECT_FALSE(back.loss);
  ASSERT_EQ(back.samples.size(), 5U);
  EXPECT_EQ(as<UnknownSample>(back.samples[0]).mrpt_class, "mrpt::obs::CActionCollection");
  EXPECT_TRUE(std::holds_alternative<InsSample>(back.samples[1].reading));
  EXPECT_TRUE(std::holds_alternative<DvlSample>(back.samples[2].reading));
  EXPECT_EQ(back.samples[3].time, after(kStart, 1.7));
  EXPECT_EQ(back.samples[4].time, after(kStart, 2.0));
}

TEST(Rawlog, WhatIsNoneIsRefused) {
  const mrpt::poses::CPose3D pose;
  EXPECT_EQ(rawlogErrorOf(writePlain({&pose})), "byte 0: holds a mrpt::poses::CPose3D: is no rawlog");
}

TEST(Rawlog, WhatIsNoneIsPassedOverBetweenEntries) {
  const CObservationIMU first = imuLabelled("INS", 1.0), last = imuLabelled("INS", 2.0);
  const mrpt::poses::CPose3D pose;
  const ReadBack back = readRecording(writePlain({&first, &pose, &last}));
  EXPECT_FALSE(back.loss);
  ASSERT_EQ(back.samples.size(), 3U);
  EXPECT_EQ(as<UnknownSample>(back.samples[1]).mrpt_class, "mrpt::poses::CPose3D");
  EXPECT_EQ(as<UnknownSample>(back.samples[1]).unreadable, "no observation");
  EXPECT_TRUE(std::holds_alternative<InsSample>(back.samples[2].reading));
}

TEST(Rawlog, UnknownEntriesArePassedOver) {
  const CObservationIMU ins = imuLabelled("INS", 1.0), other = imuLabelled("XSENS", 2.0),
                        last = imuLabelled("DVL", 4.0);
  CObservationComment remark;
  remark.text = "[recording]\nvehicle = another\n";
  remark.timestamp = toMrpt(after(kStart, 3.0));
  CObservationOdometry odometry;
  odometry.sensorLabel = "WHEELS";
  CObservationBearingRange bearing;
  bearing.sensorLabel = "MARKERS";
  bearing.timestamp = toMrpt(after(kStart, 3.0));
  const ReadBack back = readRecording(writePlain({&ins, &other, &odometry, &remark, &bearing, &last}));
  EXPECT_FALSE(back.loss);
  ASSERT_EQ(back.samples.size(), 6U);
  EXPECT_TRUE(std::holds_alternative<InsSample>(back.samples[0].reading));
  EXPECT_EQ(back.samples[1].label, "XSENS");
  EXPECT_EQ(as<UnknownSample>(back.samples[1]).mrpt_class, "mrpt::obs::CObservationIMU");
  EXPECT_EQ(as<UnknownSample>(back.samples[2]).mrpt_class, "mrpt::obs::CObservationOdometry");
  EXPECT_EQ(back.samples[2].label, "WHEELS");
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

TEST(Rawlog, MarkersOfOthersShareTheirSigmas) {
  CObservationBearingRange bearing;
  bearing.sensorLabel = "MARKER_SIGHTS";
  bearing.timestamp = toMrpt(kStart);
  bearing.sensor_std_range = 0.5F;
  bearing.sensor_std_yaw = 0.25F;
  bearing.sensor_std_pitch = 0.125F;
  bearing.sensedData.resize(1);
  const ReadBack back = readRecording(writePlain({&bearing}));
  const Matrix3d expected = Vector3d(0.25, 0.0625, 0.015625).asDiagonal();
  EXPECT_EQ(as<MarkersSample>(back.samples.at(0)).markers.at(0).covariance, expected);
}

TEST(Rawlog, SharedSamplesAreReadWhole) {
  FATHOM_NEEDS_SHARED("data/sample");
  int recordings = 0;
  for (const auto& entry : fs::directory_iterator(sharedData("data/sample"))) {
    SCOPED_TRACE(entry.path());
    std::map<std::string, int> counts;
    const ReadBack back = readRecording(entry.path() / "recording.rawlog");
    for (const Sample& sample : back.samples) ++counts[sample.label];
    // As `rawlog-edit --info` counts them.
    const auto images = static_cast<int>(
        std::distance(std::filesystem::directory_iterator(entry.path() / "recording_Images"), {}));
    const std::map<std::string, int> expected{
        {"CAMERA", images}, {"DEPTH", 900}, {"DVL", 900}, {"DVL_BEAMS", 900}, {"INS", 18001}};
    EXPECT_EQ(counts, expected);
    EXPECT_FALSE(back.loss);
    ++recordings;
  }
  EXPECT_GT(recordings, 0);
}

}  // namespace
}  // namespace fathom::test
