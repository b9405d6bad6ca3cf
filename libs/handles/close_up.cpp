#include "handles/close_up.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr std::array kSizes{32, 48, 64, 96, 128, 192, 256, 384};
constexpr double kMargin_px = 3;

/// Turns the optical axis into a direction, by the least turn.
Matrix3d turnTo(const Vector3d& direction) { return rotationBetween(Vector3d::UnitZ(), direction); }

}  // namespace

CloseUp closeUpOf(const PosedPanelImage& image, const Handle& handle) {
  const SweptBox box = sweptBoxOf(handle);
  const Pose T_camera_foot = image.T_camera_panel * Pose{Matrix3d::Identity(), handle.position_panel};
  const Vector3d middle = T_camera_foot * Vector3d(0, 0, 0.5 * box.top_m);
  const Matrix3d R_camera_close = turnTo(middle);

  double largest = 0;
  for (const Vector3d& corner : box.corners()) {
    const Vector3d p = R_camera_close.transpose() * (T_camera_foot * corner);
    largest = std::max({largest, std::abs(p.x() / p.z()), std::abs(p.y() / p.z())});
  }
  CloseUp close;
  const double f_px = image.camera.fx_px, needed_px = 2 * (largest * f_px + kMargin_px);
  const auto size = std::find_if(kSizes.begin(), kSizes.end(), [&](int s) { return s >= needed_px; });
  const int side = size == kSizes.end() ? kSizes.back() : *size;
  const double centre = 0.5 * (side - 1);
  close.camera = {
      .width_px = side, .height_px = side, .fx_px = f_px, .fy_px = f_px, .cx_px = centre, .cy_px = centre};
  close.T_panel_camera = image.T_camera_panel.inverse() * Pose{R_camera_close, Vector3d::Zero()};

  cv::Mat places(side, side, CV_32FC2);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const Vector3d sight = R_camera_close * Vector3d((column - centre) / f_px, (row - centre) / f_px, 1);
      const Vector2d pixel =
          sight.z() > 0 ? image.projector.project(Vector3d(sight * middle.norm())) : Vector2d(-1e6, -1e6);
      places.at<cv::Vec2f>(row, column) = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
    }
  cv::remap(image.light, close.light, places, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);

  std::vector<cv::Point> outline, hull;
  for (const Vector3d& point : box.rims()) {
    const Vector3d p = R_camera_close.transpose() * (T_camera_foot * point);
    outline.emplace_back(cvRound(f_px * p.x() / p.z() + centre), cvRound(f_px * p.y() / p.z() + centre));
  }
  cv::convexHull(outline, hull);
  close.in_reach = cv::Mat::zeros(side, side, CV_8UC1);
  cv::fillConvexPoly(close.in_reach, hull, 255);
  return close;
}

}  // namespace fathom
