// What the audit says of a recording's images.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "audit/checks.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

/// Names of the findings about four images, each a ramp over so many numbers.
std::vector<std::string> findingsOfRamp(int type, double step) {
  const auto folder = test::scratchFolder();
  Streams streams;
  ImageStream& stream = streams.images["CAMERA"];
  for (int i = 0; i < 4; ++i) {
    cv::Mat image(40, 60, type);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const double number = (u + v + i) % 60 * step;
        if (type == CV_8UC1)
          image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(number);
        else
          image.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(number);
      }
    stream.files.push_back(std::to_string(i) + ".png");
    cv::imwrite(folder / stream.files.back(), image);
  }
  stream.intrinsics.model.width_px = 60;
  stream.intrinsics.model.height_px = 40;
  std::vector<Finding> findings;
  checkImages(streams, folder, findings);
  std::vector<std::string> names;
  for (const Finding& finding : findings) names.push_back(finding.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(ImageChecks, BlankIsWhatHasNoGrayLevelsOfItsOwn) {
  EXPECT_EQ(findingsOfRamp(CV_8UC1, 1), Names{});
  EXPECT_EQ(findingsOfRamp(CV_8UC1, 0.04), Names{"images-blank"});
  EXPECT_EQ(findingsOfRamp(CV_16UC1, 3), Names{});  // 177 of 65 536
  EXPECT_EQ(findingsOfRamp(CV_16UC1, 0.04), Names{"images-blank"});
}

TEST(ImageChecks, EightBitsIn16AreBlankWhereTheyAreIn8) {
  EXPECT_EQ(findingsOfRamp(CV_16UC1, 257), Names{});
  std::vector<Finding> findings;
  Streams streams;
  const auto folder = test::scratchFolder();
  cv::Mat image(40, 60, CV_16UC1, cv::Scalar(257 * 80));
  image.at<std::uint16_t>(3, 3) = 257 * 82;
  for (const char* name : {"a.png", "b.png"}) {
    streams.images["CAMERA"].files.emplace_back(name);
    cv::imwrite(folder / name, image);
  }
  streams.images["CAMERA"].intrinsics.model.width_px = 60;
  streams.images["CAMERA"].intrinsics.model.height_px = 40;
  checkImages(streams, folder, findings);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].name, "images-blank");
}

}  // namespace
}  // namespace fathom
