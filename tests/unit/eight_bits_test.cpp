#include "imaging/eight_bits.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

/// A ramp from one number to another, in 200 rows of 256.
cv::Mat ramp(int from, int to) {
  cv::Mat image(200, 256, CV_16UC1);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      image.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(from + (to - from) * u / 255);
  return image;
}

TEST(EightBits, AreTheRangeThatIsUsed) {
  const LevelRange low = usedRange(ramp(20000, 20400));
  EXPECT_EQ(low.black, 20000);
  EXPECT_EQ(low.white, 20400);
  const LevelRange few = usedRange(ramp(500, 540));  // no contrast that is not there
  EXPECT_EQ(few.white - few.black, 255);
  const LevelRange whole = usedRange(ramp(10000, 50000));
  EXPECT_EQ(whole.black, 0);
  EXPECT_EQ(whole.white, 65535);
}

TEST(EightBits, LeaveOutHotAndDeadPixels) {
  cv::Mat image = ramp(20000, 20400);
  image.at<std::uint16_t>(7, 7) = 65535;
  image.at<std::uint16_t>(9, 9) = 0;
  EXPECT_EQ(usedRange(image).black, 20000);
  EXPECT_EQ(usedRange(image).white, 20400);
}

TEST(EightBits, OfEightTimes257AreTheSame) {
  const cv::Mat eight = inEightBits(ramp(0, 65535));
  cv::Mat sixteen;
  eight.convertTo(sixteen, CV_16U, 257);
  EXPECT_EQ(cv::norm(inEightBits(sixteen), eight, cv::NORM_INF), 0);
  EXPECT_EQ(inEightBits(eight).data, eight.data);
}

TEST(EightBits, OfFullScaleAreTheSheets) {
  const cv::Mat image = ramp(0, 4095);
  EXPECT_EQ(bitsOf(image, 12), 12);
  EXPECT_EQ(bitsOf(image, 8), 16);
  EXPECT_EQ(bitsOf(ramp(0, 65520), 12), 16);  // the highest bits, not the lowest
  EXPECT_EQ(bitsOf(inEightBits(image), 12), 8);
  EXPECT_EQ(fullScaleInEightBits(image, 12).at<std::uint8_t>(0, 255), 255);
  EXPECT_EQ(fullScaleInEightBits(image, 16).at<std::uint8_t>(0, 255), 16);
}

}  // namespace
}  // namespace fathom
