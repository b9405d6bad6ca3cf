#include "recording/object_layout.h"

#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation6DFeatures.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include "core/files.h"
#include "recording/mrpt_types.h"
#include "support/recordings.h"
#include "support/shared_data.h"

// The truth is the installed MRPT: what it serializes must be measured to the byte.
namespace fathom::test {
namespace {

using namespace mrpt::obs;

std::string serialized(const mrpt::serialization::CSerializable& object) {
  mrpt::io::CMemoryStream stream;
  mrpt::serialization::archiveFrom(stream) << object;
  return {static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()};
}

ObjectExtent measureBytes(const std::string& bytes) {
  const auto file = scratchFolder() / "object.rawlog";
  writeTextFile(file, bytes);
  ByteStream in(file);
  return measureObject(in);
}

/// Label and time are found, and the length is MRPT's, whatever follows.
void expectMeasured(CObservation& observation, bool labelled = true) {
  observation.timestamp = toMrpt(kStart);
  if (labelled) observation.sensorLabel = "LABEL";
  const std::string bytes = serialized(observation);
  const ObjectExtent extent = measureBytes(bytes + "anything");
  ASSERT_EQ(extent.kind, ObjectExtent::Kind::kKnown) << extent.reason;
  EXPECT_EQ(extent.bytes, bytes.size());
  EXPECT_EQ(extent.time, kStart);
  EXPECT_EQ(extent.label, labelled ? "LABEL" : "");
  EXPECT_EQ(extent.mrpt_class, observation.GetRuntimeClass()->className);
}

TEST(ObjectLayout, MeasuresWhatMrptWrites) {
  CObservationComment comment;
  comment.text = "line 1\nline 2";
  expectMeasured(comment, false);

  CObservationIMU imu;
  imu.set(IMU_WX, 1.0);
  expectMeasured(imu);

  CObservationRange range;
  expectMeasured(range);
  range.sensedData.resize(5);
  expectMeasured(range);

  CObservationRobotPose pose;
  expectMeasured(pose);

  CObservationBearingRange bearing;
  bearing.sensedData.resize(2);
  bearing.sensedData[1].landmarkID = 7;
  expectMeasured(bearing);
  bearing.validCovariances = true;
  expectMeasured(bearing);

  CObservation6DFeatures features;
  expectMeasured(features);
  features.sensedFeatures.resize(3);
  expectMeasured(features);
}

TEST(ObjectLayout, MeasuresImagesInAndOutsideTheObject) {
  CObservationImage image;
  image.cameraParams.cameraName = "a camera of some name";
  image.image.setExternalStorage("picture.png");
  expectMeasured(image);
  image.image = mrpt::img::CImage();
  expectMeasured(image);
  for (const auto channels : {mrpt::img::CH_GRAY, mrpt::img::CH_RGB}) {
    image.image = mrpt::img::CImage(7, 5, channels);
    expectMeasured(image);
    image.image = mrpt::img::CImage(300, 200, channels);
    expectMeasured(image);
  }

  CObservationStereoImages stereo;
  stereo.imageLeft.setExternalStorage("left.png");
  expectMeasured(stereo);
  stereo.hasImageRight = true;
  stereo.imageRight.setExternalStorage("right.png");
  expectMeasured(stereo);
  stereo.hasImageDisparity = true;
  stereo.imageDisparity = mrpt::img::CImage(30, 20, mrpt::img::CH_GRAY);
  expectMeasured(stereo);
}

TEST(ObjectLayout, EveryCutIsNoticed) {
  CObservationStereoImages stereo;
  stereo.imageLeft.setExternalStorage("left.png");
  stereo.hasImageRight = true;
  stereo.imageRight.setExternalStorage("right.png");
  const std::string bytes = serialized(stereo);
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_EQ(measureBytes(bytes.substr(0, size)).kind, ObjectExtent::Kind::kDamaged) << size;
}

TEST(ObjectLayout, ImpossibleLengthsCostNothing) {
  CObservationRange range;
  range.sensedData.resize(1);
  range.sensorLabel = "LABEL";
  range.timestamp = toMrpt(kStart);
  std::string bytes = serialized(range);
  const std::string count("\x01\0\0\0", 4);
  const auto at = bytes.find(count, 32);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 4, "\xff\xff\xff\xff");
  const ObjectExtent extent = measureBytes(bytes);
  EXPECT_EQ(extent.kind, ObjectExtent::Kind::kDamaged);
  EXPECT_EQ(extent.reason, "a length of 4294967295 is impossible");
}

TEST(ObjectLayout, OtherObservationsEndWhereTheNextBegins) {
  CObservationOdometry odometry;
  CObservation2DRangeScan scan;
  scan.resizeScan(100);
  CObservationIMU imu;
  imu.timestamp = toMrpt(kStart);
  for (const CObservation* unknown : std::initializer_list<const CObservation*>{&odometry, &scan}) {
    const std::string bytes = serialized(*unknown);
    for (const std::string& next : {std::string(), serialized(imu), serialized(scan)}) {
      const ObjectExtent extent = measureBytes(bytes + next);
      ASSERT_EQ(extent.kind, ObjectExtent::Kind::kSkipped) << extent.reason;
      EXPECT_EQ(extent.bytes, bytes.size());
    }
    EXPECT_EQ(measureBytes(bytes + "nonsense").kind, ObjectExtent::Kind::kDamaged);
  }
}

TEST(ObjectLayout, SaysWhatAnythingElseIs) {
  EXPECT_EQ(measureBytes(serialized(CSensoryFrame())).kind, ObjectExtent::Kind::kForeign);
  EXPECT_EQ(measureBytes("plain text, no rawlog").reason, "no object begins where one should");
  std::string bytes = serialized(CObservationIMU());
  const auto version = bytes.find("IMU") + 3;
  bytes[version] = 9;
  EXPECT_EQ(measureBytes(bytes).reason,
            "mrpt::obs::CObservationIMU of version 9, where MRPT 2.5 writes version 4");
  bytes[version - 1] = 'V';
  EXPECT_EQ(measureBytes(bytes).reason, "class `mrpt::obs::CObservationIMV` is none of MRPT's");
}

}  // namespace
}  // namespace fathom::test
