// Corners fitted to drawn images: how far from the truth, and whether the covariance says so.
#include "fiducials/corner_refinement.h"

#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "support/marker_images.h"

namespace fathom {
namespace {

using test::drawMarkers;
using test::lookingAtPanel;
using test::markerAt;
using test::trueCorners;

struct CornerStatistics {
  double rms_px = 0;           ///< of a coordinate
  double corner_nees = 0;      ///< mean per corner; 2 where the covariance is right
  double marker_nees = 0;      ///< mean per marker; 8
  int count = 0, refused = 0;  ///< markers
};

/// Markers of 7 x 7 cells, `cell_px` wide seen from the front, in every attitude; rough corners are off by up
/// to a third of a cell, but no more than 1.5 px, or 1 px where the blur is known.
CornerStatistics refineMany(const CameraModel& camera, double cell_px, const test::Look& look, bool know_lens,
                            int count, const std::optional<double>& blur_sigma_px = std::nullopt) {
  CornerStatistics statistics;
  Random random(11);
  for (int i = 0; i < count; ++i) {
    const Marker marker =
        markerAt("DICT_ARUCO_ORIGINAL", (17 + 29 * i) % 1024, 0.2, random.uniform(-0.1, 0.1),
                 random.uniform(-0.1, 0.1), random.uniform(0, 6.28));
    const double distance_m = camera.fx_px * 0.2 / (7 * cell_px);
    const Pose T_camera_panel =
        lookingAtPanel(distance_m, random.uniform(0, 0.6), random.uniform(0, 6.28), random.uniform(0, 6.28));
    const cv::Mat image = drawMarkers({marker}, camera, T_camera_panel, look, random);
    const auto truth = trueCorners(marker, camera, T_camera_panel);
    auto rough = truth;
    const double slack_px = std::min(cell_px / 3, blur_sigma_px ? 1.0 : 1.5);
    for (Vector2d& corner : rough)
      corner += 0.7 * slack_px * Vector2d(random.uniform(-1, 1), random.uniform(-1, 1));
    const auto refined = refineCorners(image, rough, cell_px, know_lens ? &camera : nullptr, blur_sigma_px);
    if (!refined) {
      ++statistics.refused;
      continue;
    }
    Vector8d error;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto row = static_cast<Eigen::Index>(2 * k);
      error.segment<2>(row) = refined->corners_px[k] - truth[k];
      const Eigen::Matrix2d covariance = refined->covariance_px2.block<2, 2>(row, row);
      const Vector2d corner_error = error.segment<2>(row);
      statistics.corner_nees += 0.25 * normalizedSquare(covariance, corner_error);
    }
    statistics.rms_px += error.squaredNorm() / 8;
    statistics.marker_nees += normalizedSquare(refined->covariance_px2, error);
    ++statistics.count;
  }
  statistics.rms_px = std::sqrt(statistics.rms_px / statistics.count);
  statistics.corner_nees /= statistics.count;
  statistics.marker_nees /= statistics.count;
  return statistics;
}

TEST(CornerRefinement, IsExactOnCleanImages) {
  test::Look look;
  look.noise_sigma = 0;
  const auto found = refineMany({}, 10, look, false, 20);
  EXPECT_EQ(found.refused, 0);
  EXPECT_LT(found.rms_px, 0.015);  // seen: 0.01
}

/// The fit's errors are the noise's where noise dominates: 4 digital numbers of 170, seven cells of 5 to 14
/// px.
TEST(CornerRefinement, CovarianceIsHonestUnderNoise) {
  test::Look look;
  look.noise_sigma = 5;
  look.supersampling = 6;
  for (const double cell_px : {6.0, 9.0, 14.0})
    for (const double blur : {0.6, 1.1}) {
      look.blur_sigma_px = blur;
      const auto found = refineMany({}, cell_px, look, false, 30);
      // 30 markers: the mean of 240 whitened squares scatters by 9 %; the model's own 0.01 px makes it
      // cautious where noise is small.
      EXPECT_GT(found.corner_nees, 1.0) << cell_px << " px, blur " << blur;
      EXPECT_LT(found.corner_nees, 2.6) << cell_px << " px, blur " << blur;
      EXPECT_GT(found.marker_nees, 4.0) << cell_px << " px, blur " << blur;
      EXPECT_LT(found.marker_nees, 10.4) << cell_px << " px, blur " << blur;
      EXPECT_LT(found.rms_px, 0.08);
      EXPECT_LE(found.refused, 1);
    }
}

/// A neighbour's blur is about right.
TEST(CornerRefinement, KnownBlurLeavesOutTheWayFromAfarOnly) {
  test::Look look;
  look.noise_sigma = 2;
  look.supersampling = 4;
  for (const double cell_px : {4.0, 9.0}) {
    const auto unknown = refineMany({}, cell_px, look, false, 30);
    for (const double blur_px : {0.4, 0.6, 0.9}) {
      const auto known = refineMany({}, cell_px, look, false, 30, blur_px);
      EXPECT_EQ(known.refused, 0) << cell_px << " px, blur " << blur_px;
      EXPECT_LT(known.rms_px, 1.1 * unknown.rms_px) << cell_px << " px, blur " << blur_px;
      EXPECT_LT(known.marker_nees, 1.2 * unknown.marker_nees) << cell_px << " px, blur " << blur_px;
    }
  }
}

TEST(CornerRefinement, SmallBlurredMarkersSayThatTheyAreWorse) {
  test::Look look;
  look.blur_sigma_px = 1.0;
  look.noise_sigma = 2;
  const auto found = refineMany({}, 4, look, false, 40);
  EXPECT_LT(found.rms_px, 0.12);
  EXPECT_LT(found.marker_nees, 16.0);  // neighbouring cells show through: not Gaussian, but not far off
}

TEST(CornerRefinement, KnownLensStraightensEdges) {
  CameraModel camera;
  camera.k1 = -0.25;
  test::Look look;
  look.noise_sigma = 0.5;
  look.supersampling = 4;
  const auto ignorant = refineMany(camera, 25, look, false, 6);
  const auto knowing = refineMany(camera, 25, look, true, 6);
  EXPECT_GT(ignorant.rms_px, 0.1);
  EXPECT_LT(knowing.rms_px, 0.03);
}

TEST(CornerRefinement, RefusesWhereThereIsNoEdge) {
  const std::array<Vector2d, 4> square{Vector2d(50, 50), {90, 50}, {90, 90}, {50, 90}};
  EXPECT_FALSE(refineCorners(cv::Mat(200, 200, CV_8UC1, cv::Scalar(90)), square, 6));
  Random random(1);
  cv::Mat noise(200, 200, CV_8UC1);
  for (int row = 0; row < noise.rows; ++row)
    for (int column = 0; column < noise.cols; ++column)
      noise.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(random.uniform(80, 100));
  if (const auto found = refineCorners(noise, square, 6)) {
    EXPECT_GT(std::sqrt(found->covariance_px2.trace() / 8), 0.1);
  }
  const std::array<Vector2d, 4> outside{Vector2d(-50, -50), {-9, -50}, {-9, -9}, {-50, -9}};
  EXPECT_FALSE(refineCorners(noise, outside, 6));
  const std::array<Vector2d, 4> flat{Vector2d(50, 50), {90, 50}, {90, 50}, {50, 50}};
  EXPECT_FALSE(refineCorners(noise, flat, 6));
}

}  // namespace
}  // namespace fathom
