#include "handles/front_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr double kMargin = 1.25;      // around what the box covers: what the handle is to be told from
constexpr double kFewestPixels = 10;  // of the image, across the box
constexpr int kSmallest = 72, kLargest = 240;  // pixels of the view across
constexpr double kSteepest = 0.2;  // cosine to the face's normal: from flatter nothing is straightened

/// Where the plane z = height of the foot frame is met from the eye through a point.
Vector2d onPlane(const Vector3d& eye, const Vector3d& point, double height_m) {
  const Vector3d along = point - eye;
  return (eye + (height_m - eye.z()) / along.z() * along).head<2>();
}

std::vector<cv::Point> rounded(const std::vector<Vector2d>& points) {
  std::vector<cv::Point> pixels;
  for (const Vector2d& p : points) pixels.emplace_back(cvRound(p.x()), cvRound(p.y()));
  return pixels;
}

/// The image's light at the places of the view's pixels, side x side of them.
cv::Mat lightFromTheFront(const PosedPanelImage& image, const Pose& T_camera_foot, double height_m, int side,
                          const FrontView& view) {
  cv::Mat places(side, side, CV_32FC2);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const Vector3d point((column - view.axis_px.x()) * view.m_per_px,
                           (view.axis_px.y() - row) * view.m_per_px, height_m);
      const Vector2d pixel = image.projector.project(Vector3d(T_camera_foot * point));
      places.at<cv::Vec2f>(row, column) = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
    }
  cv::Mat light;
  cv::remap(image.light, light, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return light;
}

/// Where the view can show the handle at all, whatever its angle.
cv::Mat regionInReach(const SweptBox& box, const Vector3d& eye, double height_m, int side,
                      const FrontView& view) {
  std::vector<Vector2d> outline;
  for (const Vector3d& p : box.rims()) outline.push_back(view.pixelOf(onPlane(eye, p, height_m)));
  std::vector<cv::Point> hull;
  cv::convexHull(rounded(outline), hull);
  cv::Mat in_reach = cv::Mat::zeros(side, side, CV_8UC1);
  cv::fillConvexPoly(in_reach, hull, 255);
  return in_reach;
}

}  // namespace

FrontView frontViewOf(const PosedPanelImage& image, const Handle& handle) {
  FrontView view;
  const SweptBox box = sweptBoxOf(handle);
  const double height_m = edgeHeight_m(handle);
  const Pose T_camera_foot = image.T_camera_panel * Pose{Matrix3d::Identity(), handle.position_panel};
  const Vector3d eye = T_camera_foot.inverse().position;
  if (eye.z() <= box.top_m || eye.z() < kSteepest * eye.norm()) {
    view.why_not = "seen from behind or along the panel";
    return view;
  }
  std::vector<Vector2d> in_image, in_plane;
  for (const Vector3d& corner : box.corners()) {
    const Vector3d point_camera = T_camera_foot * corner;
    if (point_camera.z() <= 0) {
      view.why_not = "out of view";
      return view;
    }
    in_image.push_back(image.projector.project(point_camera));
    in_plane.push_back(onPlane(eye, corner, height_m));
  }
  view.region_px = cv::boundingRect(rounded(in_image));
  if (!std::all_of(in_image.begin(), in_image.end(),
                   [&](const Vector2d& p) { return image.camera.contains(p); })) {
    view.why_not = "out of view";
    return view;
  }
  const double range_m = eye.norm(), across_m = range_m / image.camera.fx_px;  // of a pixel
  if (2 * box.reach_m / across_m < kFewestPixels) {
    view.why_not = "too far away";
    return view;
  }

  Vector2d smallest = in_plane.front(), largest = smallest;
  for (const Vector2d& p : in_plane) {
    smallest = smallest.cwiseMin(p);
    largest = largest.cwiseMax(p);
  }
  const Vector2d middle = 0.5 * (smallest + largest);
  const double side_m = kMargin * (largest - smallest).maxCoeff();
  const int side = std::clamp(static_cast<int>(std::lround(side_m / across_m)), kSmallest, kLargest);
  view.m_per_px = side_m / side;
  view.image_px = view.m_per_px / across_m;
  view.silhouette_px = silhouette_m2(handle) / (view.m_per_px * view.m_per_px);
  view.axis_px = {0.5 * (side - 1) - middle.x() / view.m_per_px,
                  0.5 * (side - 1) + middle.y() / view.m_per_px};

  view.light = lightFromTheFront(image, T_camera_foot, height_m, side, view);
  view.in_reach = regionInReach(box, eye, height_m, side, view);
  return view;
}

}  // namespace fathom
