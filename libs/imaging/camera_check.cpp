#include "imaging/camera_check.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/text.h"

namespace fathom {
namespace {

/// How much distort() enlarges an area: not above zero, it folds.
double enlargementAt(const CameraModel& camera, const Vector2d& ideal) {
  using Jet = ceres::Jet<double, 2>;
  const Vector2<Jet> d = camera.distort(Vector2<Jet>(Jet(ideal.x(), 0), Jet(ideal.y(), 1)));
  return d.x().v.x() * d.y().v.y() - d.x().v.y() * d.y().v.x();
}

/// How far along one direction from the axis each line of sight has a pixel of its own.
struct Reach {
  double ideal_radius = 0;
  Vector2d end_px = Vector2d::Zero();  ///< there, from the principal point
  bool folds = false;                  ///< or nothing beyond matters
};

/// By steps and bisection, until out of the image; a fold beyond 10 (84 degrees from the axis) is none.
Reach reachAlong(const CameraModel& camera, double angle_rad, double out_of_image_px) {
  constexpr double kLargest = 10, kStep = 1e-3, kEndless = 1e3;
  const Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
  const auto grows = [&](double r) { return enlargementAt(camera, r * direction) > 0; };
  const auto pixelAt = [&](double r) {
    const Vector2d d = camera.distort<double>(r * direction);
    return Vector2d(d.x() * camera.fx_px, d.y() * camera.fy_px);
  };
  for (double low = 0, high = kStep; low < kLargest; low = high, high += kStep * (1 + high)) {
    if (!grows(high)) {
      for (int i = 0; i < 60; ++i) (grows(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
      return {low, pixelAt(low), true};
    }
    if (const Vector2d pixel = pixelAt(high); pixel.norm() > out_of_image_px) return {high, pixel, false};
  }
  return {kLargest, kEndless * out_of_image_px * direction, false};
}

/// All around the axis: a polygon whose inside has lines of sight.
std::vector<Reach> reachOf(const CameraModel& camera, double out_of_image_px) {
  constexpr int kDirections = 360;
  std::vector<Reach> around;
  for (int i = 0; i < kDirections; ++i)
    around.push_back(reachAlong(camera, 2 * std::numbers::pi * i / kDirections, out_of_image_px));
  return around;
}

/// Whether the polygon winds about a point, however often: a tangential fold's may cross itself.
bool windsAbout(const Vector2d& point_px, const std::vector<Reach>& around) {
  int turns = 0;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Vector2d a = around[i].end_px - point_px, b = around[(i + 1) % around.size()].end_px - point_px;
    const double side = a.x() * b.y() - a.y() * b.x();
    if (a.y() <= 0 && b.y() > 0 && side > 0) ++turns;
    if (a.y() > 0 && b.y() <= 0 && side < 0) --turns;
  }
  return turns != 0;
}

/// Of the image's outermost pixels, from the principal point.
std::vector<Vector2d> cornersOf(const CameraModel& camera) {
  std::vector<Vector2d> corners_px;
  for (const double x_px : {-0.5, camera.width_px - 0.5})
    for (const double y_px : {-0.5, camera.height_px - 0.5})
      corners_px.emplace_back(x_px - camera.cx_px, y_px - camera.cy_px);
  return corners_px;
}

/// Of a grid of pixels, those outside the polygon.
double shareOutside(const CameraModel& camera, const std::vector<Reach>& around) {
  constexpr int kCells = 200;  // each way
  int outside = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const Vector2d cell_px(camera.width_px * (i + 0.5) / kCells - 0.5 - camera.cx_px,
                             camera.height_px * (j + 0.5) / kCells - 0.5 - camera.cy_px);
      outside += windsAbout(cell_px, around) ? 0 : 1;
    }
  return static_cast<double>(outside) / (kCells * kCells);
}

std::string sizeText(double width_px, double height_px) {
  return print("%.0f x %.0f px", width_px, height_px);
}

/// Whether a point is nearer to an image's middle than a quarter of its sides.
bool isNearMiddle(double x_px, double y_px, double width_px, double height_px) {
  return std::abs(x_px - 0.5 * width_px) < 0.25 * width_px &&
         std::abs(y_px - 0.5 * height_px) < 0.25 * height_px;
}

/// The principal point is where an image of the other orientation has its middle. Of nearly square ones both
/// middles are near: then it has to be there much rather than here.
bool looksSwapped(const CameraModel& c) {
  const double width = c.width_px, height = c.height_px;
  if (!isNearMiddle(c.cx_px, c.cy_px, height, width)) return false;
  const double from_swapped_px = std::hypot(c.cx_px - 0.5 * height, c.cy_px - 0.5 * width),
               from_own_px = std::hypot(c.cx_px - 0.5 * width, c.cy_px - 0.5 * height);
  return !isNearMiddle(c.cx_px, c.cy_px, width, height) || 3 * from_swapped_px < from_own_px;
}

}  // namespace

std::optional<Fold> foldOf(const CameraModel& camera) {
  const std::vector<Vector2d> corners_px = cornersOf(camera);
  double farthest_px = 0;
  for (const Vector2d& corner : corners_px) farthest_px = std::max(farthest_px, corner.norm());
  const std::vector<Reach> around = reachOf(camera, farthest_px);
  const auto nearest = std::min_element(around.begin(), around.end(), [](const Reach& a, const Reach& b) {
    return std::pair(!a.folds, a.end_px.norm()) < std::pair(!b.folds, b.end_px.norm());
  });
  if (!nearest->folds) return {};
  const bool sees_corners = std::all_of(corners_px.begin(), corners_px.end(),
                                        [&](const Vector2d& corner) { return windsAbout(corner, around); });
  const double blind_share = shareOutside(camera, around);
  if (blind_share == 0 && sees_corners) return {};
  return Fold{nearest->ideal_radius, nearest->end_px.norm(), farthest_px, blind_share};
}

std::vector<std::string> doubtsAbout(const CameraModel& camera) {
  std::vector<std::string> doubts;
  const double width = camera.width_px, height = camera.height_px;
  if (looksSwapped(camera))
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
