#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "image_files/encode_image.h"
#include "render/sea_floor.h"
#include "support/render_scenes.h"

namespace fathom::test {
namespace {

TEST(ToDisplay, IsSrgb) {
  cv::Mat radiance(1, 4, CV_32FC3);
  radiance.at<cv::Vec3f>(0, 0) = {0.0f, 0.5f, 1.0f};
  radiance.at<cv::Vec3f>(0, 1) = {0.002f, 0.2140f, 7.0f};
  radiance.at<cv::Vec3f>(0, 2) = {-1.0f, 0.04f, 0.85f};
  radiance.at<cv::Vec3f>(0, 3) = {0.18f, 0.18f, 0.18f};
  const cv::Mat display = toDisplay(radiance);
  EXPECT_EQ(display.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 188, 0));
  EXPECT_EQ(display.at<cv::Vec3b>(0, 1), cv::Vec3b(255, 127, 7));
  EXPECT_EQ(display.at<cv::Vec3b>(0, 2), cv::Vec3b(237, 56, 0));
  EXPECT_EQ(display.at<cv::Vec3b>(0, 3), cv::Vec3b(118, 118, 118));
  EXPECT_THROW(toDisplay(cv::Mat(2, 2, CV_8UC3)), std::invalid_argument);
}

TEST(SeaFloor, IsLevelSandThatVaries) {
  SeaFloor floor;
  floor.centre_odom = {6, -1, -2.5};
  const Surface surface = seaFloor(floor, Random(5));
  EXPECT_LE(surface.triangles.size(), 3000u);
  double sum = 0, sum_squared = 0, neighbours = 0;
  for (std::size_t k = 0; k < surface.vertices.size(); ++k) {
    const auto& vertex = surface.vertices[k];
    EXPECT_EQ(vertex.position.z(), -2.5f);
    EXPECT_LE(std::abs(vertex.position.x() - 6.0f), 10.0001f);
    EXPECT_LE(std::abs(vertex.position.y() + 1.0f), 10.0001f);
    EXPECT_EQ(vertex.normal, Eigen::Vector3f::UnitZ().eval());
    EXPECT_GE(vertex.albedo.minCoeff(), 0.02f);
    EXPECT_LE(vertex.albedo.maxCoeff(), 0.9f);
    const double relative = static_cast<double>(vertex.albedo[1]) / 0.28 - 1;
    sum += relative;
    sum_squared += relative * relative;
    if (k > 0)
      neighbours +=
          std::abs(static_cast<double>(vertex.albedo[1] - surface.vertices[k - 1].albedo[1])) / 0.28;
  }
  const auto count = static_cast<double>(surface.vertices.size());
  EXPECT_NEAR(sum / count, 0, 0.08);  // a few dozen of the largest patches
  EXPECT_NEAR(std::sqrt(sum_squared / count), floor.contrast, 0.08);
  EXPECT_LT(neighbours / count, floor.contrast);  // patches, not salt and pepper (1.13 contrast)
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3f ab = surface.vertices[b].position - surface.vertices[a].position;
    const Eigen::Vector3f ac = surface.vertices[c].position - surface.vertices[a].position;
    EXPECT_GT(ab.cross(ac).z(), 0);  // seen from above
  }
}

TEST(SeaFloor, IsTheSameForTheSameSeedOnly) {
  const auto albedos = [](std::uint64_t seed) {
    std::vector<float> values;
    for (const auto& vertex : seaFloor({}, Random(seed)).vertices) values.push_back(vertex.albedo[0]);
    return values;
  };
  EXPECT_EQ(albedos(1), albedos(1));
  EXPECT_NE(albedos(1), albedos(2));
  SeaFloor flat;
  flat.side_m = 0;
  EXPECT_THROW(seaFloor(flat, Random(1)), std::invalid_argument);
}

}  // namespace
}  // namespace fathom::test
