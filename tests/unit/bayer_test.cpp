// Raw images: what a pattern measures, and what is made of it.
#include "image_files/bayer.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "core/error.h"
#include "image_files/image_file.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

constexpr std::array kPatterns{BayerPattern::rggb, BayerPattern::grbg, BayerPattern::gbrg,
                               BayerPattern::bggr};

/// Colours that rise evenly: means of neighbours are what is between them.
cv::Mat ramp(int type) {
  cv::Mat image(24, 32, type);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const cv::Vec3i bgr(10 + 4 * u, 20 + 2 * u + 4 * v, 200 - 6 * v);
      if (type == CV_8UC3)
        image.at<cv::Vec3b>(v, u) = bgr;
      else
        image.at<cv::Vec3w>(v, u) = 256 * bgr;
    }
  return image;
}

TEST(Bayer, WhatIsBetweenMeasuredPixelsIsTheirMean) {
  for (const int type : {CV_8UC3, CV_16UC3})
    for (const BayerPattern pattern : kPatterns) {
      const cv::Mat image = ramp(type), raw = mosaic(image, pattern);
      ASSERT_EQ(raw.channels(), 1);
      const cv::Rect inside(2, 2, image.cols - 4, image.rows - 4);  // the rim has no neighbours beyond
      const cv::Mat off = cv::abs(demosaiced(raw, pattern) - image);
      EXPECT_LE(cv::norm(off(inside), cv::NORM_INF), 1) << static_cast<int>(pattern);  // rounding
    }
}

TEST(Bayer, WhatWasMeasuredStays) {
  cv::Mat image(24, 32, CV_8UC3);
  cv::theRNG().state = 5;
  cv::randu(image, 0, 256);
  for (const BayerPattern pattern : kPatterns) {
    const cv::Mat raw = mosaic(image, pattern), again = mosaic(demosaiced(raw, pattern), pattern);
    const cv::Rect inside(1, 1, image.cols - 2, image.rows - 2);
    EXPECT_EQ(cv::norm(raw(inside), again(inside), cv::NORM_INF), 0) << static_cast<int>(pattern);
  }
}

// Red in the first pixel of all is what rggb means.
TEST(Bayer, PatternsAreNamedByTheFirstFourPixels) {
  const cv::Mat red(4, 4, CV_8UC3, cv::Scalar(0, 0, 200));
  const auto measured = [&](const char* name, int v, int u) {
    return mosaic(red, bayerNamed(name).value()).at<std::uint8_t>(v, u);
  };
  EXPECT_EQ(measured("rggb", 0, 0), 200);
  EXPECT_EQ(measured("grbg", 0, 1), 200);
  EXPECT_EQ(measured("gbrg", 1, 0), 200);
  EXPECT_EQ(measured("bggr", 1, 1), 200);
  EXPECT_EQ(measured("rggb", 0, 1), 0);
  EXPECT_FALSE(bayerNamed("rgb"));
}

TEST(Bayer, AFileIsReadAsItsCameraMeasured) {
  const auto folder = test::scratchFolder();
  CameraModel camera{.width_px = 32, .height_px = 24};
  camera.bayer = BayerPattern::grbg;
  const cv::Mat image = ramp(CV_8UC3);
  cv::imwrite((folder / "raw.png").string(), mosaic(image, camera.bayer));
  cv::imwrite((folder / "colour.png").string(), image);
  EXPECT_EQ(readImage(folder / "raw.png", camera).channels(), 3);
  EXPECT_THROW(readImage(folder / "colour.png", camera), Error);
  camera.bayer = BayerPattern::none;
  EXPECT_EQ(readImage(folder / "raw.png", camera).channels(), 1);
}

}  // namespace
}  // namespace fathom
