#include "imaging/camera_check.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace fathom {
namespace {

CameraModel radialPartOf(CameraModel camera) {
  camera.p1 = camera.p2 = 0;
  return camera;
}

/// Smallest r > 0 at which the radial distortion has no slope, by steps and bisection; none below 10 (84
/// degrees from the axis).
std::optional<double> turningRadius(const CameraModel& camera) {
  constexpr double kLargest = 10, kStep = 1e-3;
  const CameraModel radial = radialPartOf(camera);
  const auto slope = [&](double r) {
    const double h = 1e-6;
    return radial.distort(Vector2d(r + h, 0)).x() - radial.distort(Vector2d(std::abs(r - h), 0)).x();
  };
  for (double low = kStep; low < kLargest; low += kStep) {
    double high = low + kStep;
    if (slope(high) > 0) continue;
    for (int i = 0; i < 60; ++i) (slope(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    return high;
  }
  return {};
}

/// From the principal point, in units of the focal lengths.
double distortedRadius(const CameraModel& camera, double x_px, double y_px) {
  return std::hypot((x_px - camera.cx_px) / camera.fx_px, (y_px - camera.cy_px) / camera.fy_px);
}

std::string sizeText(double width_px, double height_px) {
  return print("%.0f x %.0f px", width_px, height_px);
}

/// Whether a point is nearer to an image's middle than a quarter of its sides.
bool isNearMiddle(double x_px, double y_px, double width_px, double height_px) {
  return std::abs(x_px - 0.5 * width_px) < 0.25 * width_px &&
         std::abs(y_px - 0.5 * height_px) < 0.25 * height_px;
}

}  // namespace

std::optional<Fold> foldOf(const CameraModel& camera) {
  const auto turn = turningRadius(camera);
  if (!turn) return {};
  const double limit = radialPartOf(camera).distort(Vector2d(*turn, 0)).x();
  Fold fold{*turn, limit * camera.fx_px};
  double farthest = 0;
  for (const double x_px : {-0.5, camera.width_px - 0.5})
    for (const double y_px : {-0.5, camera.height_px - 0.5}) {
      farthest = std::max(farthest, distortedRadius(camera, x_px, y_px));
      fold.corner_px = std::max(fold.corner_px, std::hypot(x_px - camera.cx_px, y_px - camera.cy_px));
    }
  if (farthest <= limit) return {};
  constexpr int kCells = 200;  // each way
  int beyond = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      beyond += distortedRadius(camera, camera.width_px * (i + 0.5) / kCells - 0.5,
                                camera.height_px * (j + 0.5) / kCells - 0.5) > limit;
  fold.blind_share = static_cast<double>(beyond) / (kCells * kCells);
  return fold;
}

std::vector<std::string> doubtsAbout(const CameraModel& camera) {
  std::vector<std::string> doubts;
  const double width = camera.width_px, height = camera.height_px;
  if (isNearMiddle(camera.cx_px, camera.cy_px, height, width) &&
      !isNearMiddle(camera.cx_px, camera.cy_px, width, height))
    doubts.push_back(
        print("the principal point (%.0f, %.0f) is near the middle of ", camera.cx_px, camera.cy_px) +
        sizeText(height, width) + ", not of " + sizeText(width, height) + ": the sides look swapped");
  else if (!camera.contains({camera.cx_px, camera.cy_px}))
    doubts.push_back(
        print("the principal point (%.0f, %.0f) lies outside of the image of ", camera.cx_px, camera.cy_px) +
        sizeText(width, height) + ": the calibration seems to be of one of about " +
        sizeText(2 * camera.cx_px, 2 * camera.cy_px));
  if (const auto fold = foldOf(camera))
    doubts.push_back(
        print("the distortion turns back at r = %.3f, %.0f px from the principal point; the "
              "farthest corner is %.0f px away, and %.0f %% of the pixels have no line of sight",
              fold->ideal_radius, fold->radius_px, fold->corner_px, 100 * fold->blind_share));
  return doubts;
}

}  // namespace fathom
