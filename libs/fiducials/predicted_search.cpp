#include "fiducials/predicted_search.h"

#include <ceres/jet.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>

namespace fathom {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kQuietZone = 0.2;       ///< of the side, each side: more than a cell
constexpr double kSteepestCosine = 0.1;  ///< markers seen more aslant than 84 degrees cannot be read

/// A point of the panel in the image, and the largest sigma of its place.
struct PredictedPoint {
  Vector2d pixel;
  double sigma_px;
};

std::optional<PredictedPoint> predictPoint(const Vector3d& point_panel, const CameraModel& camera,
                                           const PanelPrediction& prediction) {
  using Jet = ceres::Jet<double, 6>;
  Vector3<Jet> position, turn;
  for (int i = 0; i < 3; ++i) {
    position[i] = Jet(prediction.T_camera_panel.position[i], i);
    turn[i] = Jet(0.0, i + 3);
  }
  const Matrix3<Jet> R = prediction.T_camera_panel.rotation.cast<Jet>() * expSO3(turn);
  const Vector3<Jet> point = R * point_panel.cast<Jet>() + position;
  if (point.z().a < 0.05) return std::nullopt;
  const Vector2<Jet> pixel = camera.project(point);
  Eigen::Matrix<double, 2, 6> J;
  J << pixel.x().v.transpose(), pixel.y().v.transpose();
  const Eigen::Matrix2d covariance = J * prediction.covariance * J.transpose();
  const double variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues().maxCoeff();
  return PredictedPoint{{pixel.x().a, pixel.y().a}, std::sqrt(std::max(0.0, variance))};
}

bool facesCamera(const Marker& marker, const Pose& T_camera_panel) {
  const Pose T_camera_marker = T_camera_panel * marker.T_panel_marker;
  const double cosine = -T_camera_marker.rotation.col(2).dot(T_camera_marker.position.normalized());
  return cosine > kSteepestCosine;
}

std::optional<PredictedMarker> predictMarker(const Marker& marker, const CameraModel& camera,
                                             const PanelPrediction& prediction) {
  if (!facesCamera(marker, prediction.T_camera_panel)) return std::nullopt;
  std::array<Vector2d, 4> corners;
  double sigma_px = 0;
  const auto corners_panel = marker.corners_panel();
  for (std::size_t k = 0; k < 4; ++k) {
    const auto point = predictPoint(corners_panel[k], camera, prediction);
    if (!point) return std::nullopt;
    corners[k] = point->pixel;
    sigma_px = std::max(sigma_px, point->sigma_px);
  }
  const auto sides = sides_px(corners);
  const auto [shortest, longest] = std::minmax_element(sides.begin(), sides.end());
  const double margin = prediction.margin_px + kSigmas * sigma_px + kQuietZone * *longest;
  Vector2d low = corners[0], high = corners[0];
  for (const Vector2d& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const auto pixel = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, double(size)));
  };
  const cv::Point first(pixel(low.x() - margin, camera.width_px), pixel(low.y() - margin, camera.height_px));
  const cv::Point last(pixel(high.x() + margin + 1, camera.width_px),
                       pixel(high.y() + margin + 1, camera.height_px));
  const cv::Rect area(first, last);
  if (area.empty()) return std::nullopt;
  return PredictedMarker{&marker, area, *shortest};
}

bool isThere(const Detection& detection, const PredictedMarker& expected) {
  const Vector2d centre = detection.centre_px();
  return expected.marker->family == detection.family && expected.marker->id == detection.id &&
         expected.area.contains(cv::Point(static_cast<int>(centre.x()), static_cast<int>(centre.y())));
}

std::vector<Detection> expectedOnly(std::vector<Detection> detections,
                                    const std::vector<PredictedMarker>& markers) {
  std::erase_if(detections, [&](const Detection& detection) {
    return std::none_of(markers.begin(), markers.end(),
                        [&](const PredictedMarker& marker) { return isThere(detection, marker); });
  });
  return detections;
}

}  // namespace

std::vector<PredictedMarker> predictMarkers(const PanelMap& map, const CameraModel& camera,
                                            const PanelPrediction& prediction) {
  std::vector<PredictedMarker> markers;
  for (const Marker& marker : map.markers)
    if (const auto predicted = predictMarker(marker, camera, prediction)) markers.push_back(*predicted);
  return markers;
}

std::vector<SearchRegion> searchRegions(const std::vector<PredictedMarker>& markers) {
  std::vector<SearchRegion> regions;
  for (const PredictedMarker& marker : markers) {
    SearchRegion joined{marker.area, marker.side_px};
    // Joining may make a region worth joining with another that was not before: look again from the start.
    for (std::size_t i = 0; i < regions.size();) {
      const cv::Rect both = regions[i].area | joined.area;
      if (both.area() > regions[i].area.area() + joined.area.area()) {
        ++i;
        continue;
      }
      joined = {both, std::min(regions[i].smallest_side_px, joined.smallest_side_px)};
      regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
    regions.push_back(joined);
  }
  return regions;
}

std::vector<Detection> detectPredicted(Detector& detector, const cv::Mat& image, const PanelMap& map,
                                       const CameraModel& camera, const PanelPrediction& prediction) {
  const auto markers = predictMarkers(map, camera, prediction);
  std::vector<Detection> detections = expectedOnly(detector.detect(image, searchRegions(markers)), markers);

  std::vector<PredictedMarker> missed;
  for (const PredictedMarker& marker : markers)
    if (std::none_of(detections.begin(), detections.end(),
                     [&](const Detection& detection) { return isThere(detection, marker); }))
      missed.push_back(marker);
  std::vector<SearchRegion> again = searchRegions(missed);
  for (SearchRegion& region : again) region.smallest_side_px = 0;  // with all the whole image would get
  for (const Detection& detection : expectedOnly(detector.detect(image, again), missed))
    detections.push_back(detection);
  std::sort(detections.begin(), detections.end(), comesBefore);
  return detections;
}

}  // namespace fathom
