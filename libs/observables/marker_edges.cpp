#include "observables/marker_edges.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "imaging/forward_scatter.h"
#include "imaging/image_model.h"
#include "observables/edge_blur.h"

namespace fathom {
namespace {

constexpr double kBorder = 1.2;  // times a marker's size: with its white rim
constexpr int kWidest_px = 128;  // of what is looked at: more edges than that are not needed
constexpr double kModel = 0.02;  // of a blur: how far a uniform one's width is off
constexpr double kRendering_px2 = 0.005;

/// Where a marker and its white rim are seen; nothing where that is not all before the camera.
std::optional<std::vector<cv::Point>> outline(const Marker& marker, const Pose& T_camera_panel,
                                              const TrueCamera& camera) {
  std::vector<cv::Point> points;
  for (const Vector3d& corner : marker.corners_panel()) {
    const Vector3d centre = marker.T_panel_marker.position;
    const Vector3d point_camera = T_camera_panel * Vector3d(centre + kBorder * (corner - centre));
    if (point_camera.z() < marker.size_m) return std::nullopt;
    const Vector2d pixel = camera.projector.project(point_camera);
    points.emplace_back(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  }
  return points;
}

/// At most so wide, about its middle, and what smoothing reaches.
cv::Rect windowOf(const std::vector<cv::Point>& points, const cv::Size& image) {
  const cv::Rect all = cv::boundingRect(points);
  const cv::Point middle = (all.tl() + all.br()) / 2;
  const cv::Size size = cv::Size(std::min(all.width, kWidest_px), std::min(all.height, kWidest_px)) +
                        cv::Size(2 * edgeReach_px(), 2 * edgeReach_px());
  return cv::Rect(middle - cv::Point(size) / 2, size) & cv::Rect({}, image);
}

/// The image's linear light and the rendering, of all colours.
struct Light {
  cv::Mat seen, rendered, around;  // CV_32FC3
  double full = 1;                 // at which a pixel is saturated
};

/// Mean of those colours that are nowhere saturated; nothing where all are.
std::optional<EdgeView> viewOf(const Light& light, const cv::Rect& window, const cv::Mat& mask,
                               const CameraSheet& sheet) {
  EdgeView view;
  view.mask = mask;
  int colours = 0;
  double variance = 0;
  for (int colour = 0; colour < 3; ++colour) {
    cv::Mat seen, rendered, around;
    cv::extractChannel(light.seen(window), seen, colour);
    double brightest = 0;
    cv::minMaxLoc(seen, nullptr, &brightest, nullptr, nullptr, mask);
    if (brightest >= light.full) continue;
    cv::extractChannel(light.rendered(window), rendered, colour);
    cv::extractChannel(light.around(window), around, colour);
    const double sigma = radianceSigma(cv::mean(seen, mask)[0], sheet);
    // Smoothed, noise of fewer pixels is as much larger.
    variance += pixelsPerMeasured(sheet.model.bayer, colour) * sigma * sigma;
    view.seen = colours == 0 ? seen : cv::Mat(view.seen + seen);
    view.rendered = colours == 0 ? rendered : cv::Mat(view.rendered + rendered);
    view.around = colours == 0 ? around : cv::Mat(view.around + around);
    ++colours;
  }
  if (colours == 0) return std::nullopt;
  for (cv::Mat* image : {&view.seen, &view.rendered, &view.around}) *image /= colours;
  view.noise = std::sqrt(variance) / colours;
  return view;
}

/// Pixels about which smoothing mixes what a panel shows only.
cv::Mat wellOnPanel(const cv::Mat& panel_mask) {
  const int side = 2 * edgeReach_px() + 1;
  cv::Mat inner;
  cv::erode(panel_mask, inner, cv::Mat::ones(side, side, CV_8UC1), {-1, -1}, 1, cv::BORDER_CONSTANT,
            cv::Scalar(0));
  return inner;
}

cv::Mat maskOf(const std::vector<cv::Point>& points, const cv::Rect& window, const cv::Mat& well_on_panel) {
  cv::Mat inside = cv::Mat::zeros(window.size(), CV_8UC1);
  std::vector<cv::Point> there;
  for (const cv::Point& point : points) there.push_back(point - window.tl());
  cv::fillConvexPoly(inside, there, cv::Scalar(255));
  return inside & well_on_panel(window);
}

}  // namespace

std::vector<MarkerBlur> markerEdges(const PosedImage& posed, const CleanPair& pair,
                                    const std::vector<PanelMap>& panels, const CameraSheet& nominal,
                                    Time time_zero) {
  CameraSheet sheet = nominal;
  sheet.bits = 8;
  const PanelMap& panel = panels[posed.panel];
  const Pose T_camera_panel = posed.T_odom_camera().inverse() * panel.T_odom_panel;
  const Light light{radianceOf(pair.recorded, sheet), pair.clean.radiance,
                    bentLight(pair.clean.radiance, posed.camera.lens, kBends.front()),
                    radianceOf((1 << sheet.bits) - 1, sheet)};
  const cv::Mat well_on_panel = wellOnPanel(pair.panel_mask);
  int place = 0;
  for (std::size_t before = 0; before < posed.panel; ++before)
    place += static_cast<int>(panels[before].markers.size());
  std::vector<MarkerBlur> found;
  for (const Marker& marker : panel.markers) {
    const int own_place = place++;
    const auto points = outline(marker, T_camera_panel, posed.camera);
    if (!points) continue;
    const cv::Rect window = windowOf(*points, light.seen.size());
    if (window.empty()) continue;
    const auto view = viewOf(light, window, maskOf(*points, window, well_on_panel), sheet);
    const auto blur = view ? edgeBlur(*view) : std::nullopt;
    if (!blur) continue;
    MarkerBlur seen;
    seen.t_s = secondsBetween(time_zero, posed.time);
    seen.image = posed.entry;
    seen.eye = posed.eye;
    seen.panel = posed.panel;
    seen.place = own_place;
    seen.point_panel = marker.T_panel_marker.position;
    seen.pixel = posed.camera.projector.project(Vector3d(T_camera_panel * seen.point_panel));
    seen.camera = posed.camera.lens;
    seen.T_robot_camera = posed.T_robot_camera;
    seen.exposure_s = nominal.exposure_s;
    seen.variance_px2 = blur->variance_px2;
    const double doubt_px2 = kRendering_px2 + kModel * blur->variance_px2.norm();
    seen.covariance_px4 = blur->covariance_px4 + doubt_px2 * doubt_px2 * Matrix3d::Identity();
    found.push_back(seen);
  }
  return found;
}

}  // namespace fathom
