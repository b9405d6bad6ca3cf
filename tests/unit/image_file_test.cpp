// Damaged images are refused with the reason; whole ones come as stored.
#include "image_files/image_file.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/random.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

cv::Mat noiseImage() {
  Random random(1);
  cv::Mat image(40, 60, CV_8UC3);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(row, column)[c] = static_cast<std::uint8_t>(random.uniform(0, 256));
  return image;
}

std::string encoded(const std::string& extension) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, noiseImage(), bytes);
  return {bytes.begin(), bytes.end()};
}

std::string whyRefused(const std::string& bytes) {
  const fs::path file = test::scratchFolder() / "image";
  writeTextFile(file, bytes);
  try {
    readImage(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.file, file.string());
    return error.why;
  }
  return "";
}

TEST(ImageFile, PngComesBackAsItWas) {
  const fs::path file = test::scratchFolder() / "image.png";
  writeTextFile(file, encoded(".png"));
  EXPECT_EQ(cv::norm(readImage(file), noiseImage(), cv::NORM_INF), 0);
}

TEST(ImageFile, SixteenBitsComeBackAsTheyWere) {
  const fs::path file = test::scratchFolder() / "image.png";
  cv::Mat image;
  noiseImage().convertTo(image, CV_16U, 3, 20000);
  cv::imwrite(file, image);
  ASSERT_EQ(readImage(file).type(), CV_16UC3);
  EXPECT_EQ(cv::norm(readImage(file), image, cv::NORM_INF), 0);
}

TEST(ImageFile, BmpComesBackAsItWas) {
  const fs::path file = test::scratchFolder() / "image.bmp";
  writeTextFile(file, encoded(".bmp"));
  EXPECT_EQ(cv::norm(readImage(file), noiseImage(), cv::NORM_INF), 0);
}

TEST(ImageFile, BmpOfAnImpossibleSizeOrCompressedIsRefused) {
  const std::string whole = encoded(".bmp");
  const auto changed = [&](std::size_t at, char value) {
    std::string damaged = whole;
    damaged[at] = value;
    return whyRefused(damaged);
  };
  EXPECT_NE(changed(18, 0).find("cannot be"), std::string::npos);     // width: was 60
  EXPECT_NE(changed(21, '\x7f').find("million"), std::string::npos);  // two thousand million wide
  EXPECT_NE(changed(30, 1).find("compressed"), std::string::npos);
}

TEST(ImageFile, ABmpsChangedHeaderIsRefusedOrRead) {
  const std::string whole = encoded(".bmp");
  for (std::size_t at = 0; at < 54; ++at)
    for (const int change : {0x01, 0x20, 0x80, 0xff}) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ change);
      whyRefused(damaged);  // throws nothing but Error
    }
}

TEST(ImageFile, JpegIsRead) { EXPECT_EQ(whyRefused(encoded(".jpg")), ""); }

TEST(ImageFile, EveryTruncationIsSeen) {
  for (const char* extension : {".png", ".jpg", ".bmp"}) {
    const std::string whole = encoded(extension);
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 7)
      EXPECT_NE(whyRefused(whole.substr(0, length)), "") << extension << " cut at " << length;
    EXPECT_NE(whyRefused(whole.substr(0, whole.size() - 1)), "") << extension;
    EXPECT_NE(whyRefused(whole.substr(0, whole.size() / 2)).find("cut off"), std::string::npos) << extension;
  }
}

TEST(ImageFile, EveryChangedByteOfAPngIsSeen) {
  const std::string whole = encoded(".png");
  for (std::size_t at = 0; at < whole.size(); at += 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    EXPECT_NE(whyRefused(damaged), "") << at;
  }
}

TEST(ImageFile, WhatIsNoImageIsSaidToBeNone) {
  EXPECT_EQ(whyRefused(""), "the file is empty");
  EXPECT_EQ(whyRefused("image,id\n"), "neither a PNG nor a JPEG nor a BMP image");
  EXPECT_THROW(readImage("/no/such.png"), Error);
  EXPECT_THROW(readImage(test::scratchFolder()), Error);
}

}  // namespace
}  // namespace fathom
