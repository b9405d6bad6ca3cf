#include "handles/swept_box.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace fathom {

std::array<Vector3d, 8> SweptBox::corners() const {
  std::array<Vector3d, 8> corners;
  for (std::size_t k = 0; k < corners.size(); ++k)
    corners[k] = {(k & 1U) != 0 ? reach_m : -reach_m, (k & 2U) != 0 ? reach_m : -reach_m,
                  (k & 4U) != 0 ? top_m : 0};
  return corners;
}

std::vector<Vector3d> SweptBox::rims() const {
  constexpr int kPoints = 24;
  std::vector<Vector3d> points;
  for (const double z_m : {0.0, top_m})
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2 * std::numbers::pi * i / kPoints;
      points.emplace_back(reach_m * std::cos(angle), reach_m * std::sin(angle), z_m);
    }
  return points;
}

SweptBox sweptBoxOf(const Handle& handle) {
  SweptBox box;
  for (const Surface::Vertex& vertex : surfaceOf(handle).vertices) {
    box.reach_m = std::max(box.reach_m, static_cast<double>(vertex.position.head<2>().norm()));
    box.top_m = std::max(box.top_m, static_cast<double>(vertex.position.z()));
  }
  return box;
}

double silhouette_m2(const Handle& handle) {
  constexpr double kPixel_m = 0.0005;
  const double reach_m = sweptBoxOf(handle).reach_m;
  const int side = 2 * static_cast<int>(reach_m / kPixel_m) + 3;
  cv::Mat picture = cv::Mat::zeros(side, side, CV_8UC1);
  const Surface surface = surfaceOf(handle);
  for (const auto& triangle : surface.triangles) {
    std::array<cv::Point, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = surface.vertices[triangle[k]].position;
      corners[k] = {cvRound((p.x() + reach_m) / kPixel_m) + 1, cvRound((p.y() + reach_m) / kPixel_m) + 1};
    }
    cv::fillConvexPoly(picture, corners.data(), 3, 255);
  }
  return cv::countNonZero(picture) * kPixel_m * kPixel_m;
}

double symmetryOf(HandleKind kind) {
  return kind == HandleKind::valve ? std::numbers::pi : 2 * std::numbers::pi;
}

double symmetryOfEdges(HandleKind kind) {
  return kind == HandleKind::wheel ? std::numbers::pi / 2 : std::numbers::pi;
}

double angleDifference(double a_rad, double b_rad, double symmetry_rad) {
  return std::remainder(a_rad - b_rad, symmetry_rad);
}

std::vector<double> anglesInRange(const Handle& handle, double angle_rad, double symmetry_rad,
                                  double beyond_rad) {
  const double first = handle.smallest_angle_rad - beyond_rad, last = handle.largest_angle_rad + beyond_rad;
  std::vector<double> angles;
  for (double angle = first + std::fmod(angle_rad - first, symmetry_rad) - symmetry_rad; angle <= last;
       angle += symmetry_rad)
    if (angle >= first) angles.push_back(angle);
  // A whole turn has its ends in common.
  if (angles.size() > 1 && angles.back() - angles.front() > 2 * std::numbers::pi - 1e-9) angles.pop_back();
  return angles;
}

}  // namespace fathom
