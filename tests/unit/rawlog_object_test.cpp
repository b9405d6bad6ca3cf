#include "recording/rawlog_object.h"

#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation6DFeatures.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/serialization/CArchive.h>

#include <new>
#include <vector>

#include "core/files.h"
#include "recording/allocation_limit.h"
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

RawlogObject readBytes(const std::string& bytes) {
  const auto file = scratchFolder() / "object.rawlog";
  writeTextFile(file, bytes);
  ByteStream in(file);
  return readObject(in);
}

/// The same object comes back, and its length is MRPT's, whatever follows.
void expectRead(CObservation& observation) {
  observation.timestamp = toMrpt(kStart);
  observation.sensorLabel = "LABEL";
  const std::string bytes = serialized(observation);
  const RawlogObject read = readBytes(bytes + "anything");
  ASSERT_EQ(read.kind, RawlogObject::Kind::kRead) << read.reason;
  EXPECT_EQ(read.bytes, bytes.size());
  EXPECT_EQ(read.mrpt_class, observation.GetRuntimeClass()->className);
  EXPECT_EQ(serialized(*read.object), bytes);
}

TEST(RawlogObjects, ReadsWhatMrptWrites) {
  CObservationComment comment;
  comment.text = "line 1\nline 2";
  expectRead(comment);

  CObservationIMU imu;
  imu.set(IMU_WX, 1.0);
  expectRead(imu);

  CObservationRange range;
  expectRead(range);
  range.sensedData.resize(5);
  expectRead(range);

  CObservationRobotPose pose;
  expectRead(pose);

  CObservationBearingRange bearing;
  bearing.sensedData.resize(2);
  bearing.sensedData[1].landmarkID = 7;
  expectRead(bearing);
  bearing.validCovariances = true;
  expectRead(bearing);

  CObservation6DFeatures features;
  expectRead(features);
  features.sensedFeatures.resize(3);
  expectRead(features);
}

TEST(RawlogObjects, ReadsImagesInAndOutsideTheObject) {
  CObservationImage image;
  image.cameraParams.cameraName = "a camera of some name";
  image.image.setExternalStorage("picture.png");
  expectRead(image);
  image.image = mrpt::img::CImage();
  expectRead(image);
  for (const auto channels : {mrpt::img::CH_GRAY, mrpt::img::CH_RGB}) {
    image.image = mrpt::img::CImage(7, 5, channels);
    expectRead(image);
    image.image = mrpt::img::CImage(300, 200, channels);
    expectRead(image);
  }

  CObservationStereoImages stereo;
  stereo.imageLeft.setExternalStorage("left.png");
  expectRead(stereo);
  stereo.hasImageRight = true;
  stereo.imageRight.setExternalStorage("right.png");
  expectRead(stereo);
  stereo.hasImageDisparity = true;
  stereo.imageDisparity = mrpt::img::CImage(30, 20, mrpt::img::CH_GRAY);
  expectRead(stereo);
}

TEST(RawlogObjects, EveryCutIsNoticed) {
  CObservationStereoImages stereo;
  stereo.imageLeft.setExternalStorage("left.png");
  stereo.hasImageRight = true;
  stereo.imageRight.setExternalStorage("right.png");
  const std::string bytes = serialized(stereo);
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_EQ(readBytes(bytes.substr(0, size)).kind, RawlogObject::Kind::kDamaged) << size;
}

TEST(RawlogObjects, ImpossibleLengthsCostNothing) {
  CObservationRange range;
  range.sensedData.resize(1);
  range.sensorLabel = "LABEL";
  range.timestamp = toMrpt(kStart);
  std::string bytes = serialized(range);
  const std::string count("\x01\0\0\0", 4);
  const auto at = bytes.find(count, 32);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 4, "\xff\xff\xff\xff");
  const RawlogObject read = readBytes(bytes);
  EXPECT_EQ(read.kind, RawlogObject::Kind::kDamaged);
  EXPECT_EQ(read.reason, "a length is impossible");
}

/// As a later MRPT would write it: its class's name or version is none that the installed one knows.
std::string renamed(std::string bytes, const std::string& class_name) {
  const std::size_t old_size = static_cast<std::uint8_t>(bytes[0]) & 0x7fU;
  bytes[0] = static_cast<char>(0x80U | class_name.size());
  return bytes.replace(1, old_size, class_name);
}
std::string ofVersion(std::string bytes, std::string_view class_name, int version) {
  bytes[bytes.find(class_name) + class_name.size()] = static_cast<char>(version);
  return bytes;
}

TEST(RawlogObjects, OfALaterMrptEndWhereTheNextBegins) {
  CObservation2DRangeScan scan;
  scan.resizeScan(100);
  CObservationIMU imu;
  CObservationImage image;
  image.image.setExternalStorage("picture.png");
  const std::string of_unknown_class = renamed(serialized(scan), "mrpt::obs::CObservationSonarFan");
  const std::string of_later_version = ofVersion(serialized(imu), "mrpt::obs::CObservationIMU", 6);
  const std::string with_later_part = ofVersion(serialized(image), "mrpt::img::CImage", 10);
  for (const std::string& later : {of_unknown_class, of_later_version, with_later_part}) {
    for (const std::string& next :
         {std::string(), serialized(imu), serialized(CSensoryFrame()), of_unknown_class}) {
      const RawlogObject read = readBytes(later + next);
      ASSERT_EQ(read.kind, RawlogObject::Kind::kSkipped) << read.reason;
      EXPECT_EQ(read.bytes, later.size());
    }
    EXPECT_EQ(readBytes(later + "nonsense").reason, "the end of an entry cannot be found");
  }
  EXPECT_EQ(readBytes(of_unknown_class).reason, "a class that the installed MRPT does not have");
  EXPECT_EQ(readBytes(of_later_version).reason, "version 6, where the installed MRPT writes 4");
  EXPECT_EQ(readBytes(with_later_part).reason, "a part of it is of version 10");
}

TEST(RawlogObjects, SaysWhatAnythingElseIs) {
  EXPECT_EQ(readBytes(serialized(mrpt::poses::CPose3D())).kind, RawlogObject::Kind::kForeign);
  EXPECT_EQ(readBytes("plain text, no rawlog").reason, "no object begins where one should");
  const std::string bytes = serialized(CObservationIMU());
  EXPECT_EQ(readBytes(ofVersion(bytes, "CObservationIMU", 99)).reason,
            "mrpt::obs::CObservationIMU of version 99, where the installed MRPT writes 4");
  EXPECT_EQ(readBytes(renamed(bytes, "mrpt::obs::CReservation")).reason,
            "class `mrpt::obs::CReservation` is none of MRPT's");
  CObservationIMU late;
  late.timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(1));
  EXPECT_EQ(readBytes(serialized(late)).reason, "a time stamp is impossible");
}

TEST(AllocationLimit, EndsWhatItsThreadTakesInAll) {
  const auto allocate = [](std::size_t bytes) { return std::vector<char>(bytes).size(); };
  {
    const AllocationLimit limit(1000, 1000);
    EXPECT_EQ(allocate(600), 600U);
    EXPECT_THROW(allocate(600), std::bad_alloc);
    EXPECT_EQ(allocate(400), 400U);
  }
  EXPECT_EQ(allocate(2000), 2000U);
}

TEST(AllocationLimit, EndsWhatImagesTake) {
  {
    const AllocationLimit limit(10'000, 1000);
    EXPECT_EQ(cv::Mat(20, 30, CV_8U).total(), 600U);
    EXPECT_THROW(cv::Mat(20, 30, CV_8U), std::bad_alloc);
    // Of a damaged file: asked of the allocator itself, it is more than any machine has.
    EXPECT_THROW(cv::Mat(0x7fffffff, 0x7fffffff, CV_8U), std::bad_alloc);
  }
  EXPECT_EQ(cv::Mat(40, 50, CV_8U).total(), 2000U);
}

TEST(RawlogObjects, AnImageOfImpossibleSizeIsDamage) {
  const std::int32_t width = 64, height = 48;
  CObservationImage observation;
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(true);
  observation.image.resize(width, height, mrpt::img::CH_GRAY);
  std::string bytes = serialized(observation);
  mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);
  ASSERT_EQ(readBytes(bytes).kind, RawlogObject::Kind::kRead);
  std::string size(8, '\0'), hostile = size;
  std::memcpy(size.data(), &width, 4);
  std::memcpy(size.data() + 4, &height, 4);
  const std::size_t at = bytes.find(size);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 8, "\xff\xff\xff\x7f\xff\xff\xff\x7f", 8);
  const RawlogObject object = readBytes(bytes);
  EXPECT_NE(object.kind, RawlogObject::Kind::kRead);
  EXPECT_EQ(object.reason, "a length is impossible");
}

}  // namespace
}  // namespace fathom::test
