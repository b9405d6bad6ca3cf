#include "fiducials/predicted_search.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/linear_algebra.h"
#include "core/stable_sort.h"

namespace fathom {
namespace {

using Matrix26d = Eigen::Matrix<double, 2, 6>;

constexpr double kSigmas = 3.0;
constexpr double kMapSigma_px = 0.2;  ///< what map and calibration err by
constexpr int kLargestFailures = 3;
constexpr double kQuietZone = 0.2;       ///< of the side, each side: more than a cell
constexpr double kSteepestCosine = 0.1;  ///< markers seen more aslant than 84 degrees cannot be read

/// A point of the panel in the image.
struct PredictedPoint {
  Vector2d pixel;
  Matrix26d J;  ///< by position and rotation, see PanelPrediction
};

std::optional<PredictedPoint> predictPoint(const Vector3d& point_panel, const CameraModel& camera,
                                           const Pose& T_camera_panel) {
  using Jet = ceres::Jet<double, 3>;
  const Vector3d point = T_camera_panel * point_panel;
  if (point.z() < 0.05) return std::nullopt;
  const Vector2<Jet> pixel =
      camera.project(Vector3<Jet>(Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2)));
  PredictedPoint predicted;
  predicted.pixel = {pixel.x().a, pixel.y().a};
  predicted.J.leftCols<3>() << pixel.x().v.transpose(), pixel.y().v.transpose();
  predicted.J.rightCols<3>() =
      -predicted.J.leftCols<3>() * T_camera_panel.rotation * crossMatrix(point_panel);
  return predicted;
}

/// A marker's corners in the image.
struct PredictedCorners {
  std::array<Vector2d, 4> corners_px;
  Eigen::Matrix<double, 8, 6> J;
  double sigma_px;  ///< the largest of a corner, in any direction
};

std::optional<PredictedCorners> predictCorners(const Marker& marker, const CameraModel& camera,
                                               const PanelPrediction& prediction) {
  PredictedCorners predicted{};
  const auto corners_panel = marker.corners_panel();
  double variance = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto point = predictPoint(corners_panel[k], camera, prediction.T_camera_panel);
    if (!point) return std::nullopt;
    predicted.corners_px[k] = point->pixel;
    predicted.J.middleRows<2>(static_cast<Eigen::Index>(2 * k)) = point->J;
    const Eigen::Matrix2d C = point->J * prediction.covariance * point->J.transpose();
    // The larger eigenvalue.
    variance = std::max(variance, 0.5 * C.trace() + std::hypot(0.5 * (C(0, 0) - C(1, 1)), C(0, 1)));
  }
  predicted.sigma_px = std::sqrt(variance);
  return predicted;
}

bool facesCamera(const Marker& marker, const Pose& T_camera_panel) {
  const Pose T_camera_marker = T_camera_panel * marker.T_panel_marker;
  const double cosine = -T_camera_marker.rotation.col(2).dot(T_camera_marker.position.normalized());
  return cosine > kSteepestCosine;
}

std::optional<PredictedMarker> predictMarker(const Marker& marker, const CameraModel& camera,
                                             const PanelPrediction& prediction) {
  if (!facesCamera(marker, prediction.T_camera_panel)) return std::nullopt;
  const auto predicted = predictCorners(marker, camera, prediction);
  if (!predicted) return std::nullopt;
  const auto& corners = predicted->corners_px;
  const auto sides = sides_px(corners);
  const auto [shortest, longest] = std::minmax_element(sides.begin(), sides.end());
  const double margin = prediction.margin_px + kSigmas * predicted->sigma_px + kQuietZone * *longest;
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

std::vector<PredictedMarker> missedOf(std::vector<PredictedMarker> markers,
                                      const std::vector<Detection>& detections) {
  std::erase_if(markers, [&](const PredictedMarker& marker) {
    return std::any_of(detections.begin(), detections.end(),
                       [&](const Detection& detection) { return isThere(detection, marker); });
  });
  return markers;
}

/// The margin counts as three sigma more: a shift of the panel along the image, and a turn that moves its
/// outermost marker as far.
Matrix6d covarianceWithMargin(const PanelPrediction& prediction, const PanelMap& map,
                              const CameraModel& camera) {
  const double distance_m = std::max(0.1, prediction.T_camera_panel.position.norm());
  double radius_m = 0.1;
  for (const Marker& marker : map.markers)
    radius_m = std::max(radius_m, marker.T_panel_marker.position.norm());
  const double shift_m = prediction.margin_px / kSigmas * distance_m / camera.fx_px;
  Matrix6d covariance = prediction.covariance;
  covariance.diagonal().head<3>().array() += shift_m * shift_m;
  covariance.diagonal().tail<3>().array() += shift_m * shift_m / (radius_m * radius_m);
  return covariance;
}

/// The Kalman filter's update with a marker's corners.
void correct(PanelPrediction& prediction, const PredictedCorners& predicted, const Detection& detection) {
  Vector8d innovation;
  for (std::size_t k = 0; k < 4; ++k)
    innovation.segment<2>(static_cast<Eigen::Index>(2 * k)) =
        detection.corners_px[k] - predicted.corners_px[k];
  const auto& J = predicted.J;
  const Eigen::Matrix<double, 6, 8> PJt = prediction.covariance * J.transpose();
  const Matrix8d S = J * PJt + detection.covariance_px2 + kMapSigma_px * kMapSigma_px * Matrix8d::Identity();
  const SymmetricFactors solver(S);
  const Eigen::Matrix<double, 6, 1> step = PJt * solver.solve(innovation);
  prediction.T_camera_panel.position += step.head<3>();
  prediction.T_camera_panel.rotation *= expSO3<double>(step.tail<3>());
  prediction.covariance -= PJt * solver.solve(PJt.transpose());
}

/// Markers confirmed in their places, and where the panel is after them.
struct Confirmed {
  std::vector<Detection> detections;
  PanelPrediction prediction;
};

/// The largest first: each marker tells more exactly where the others are.
Confirmed confirmInTurn(Detector& detector, const cv::Mat& gray, const PanelMap& map,
                        const CameraModel& camera, const PanelPrediction& prediction,
                        std::vector<PredictedMarker> markers) {
  Confirmed confirmed{{}, prediction};
  confirmed.prediction.covariance = covarianceWithMargin(prediction, map, camera);
  stableSort(markers, [](const auto& a, const auto& b) { return a.side_px > b.side_px; });
  std::optional<double> blur_sigma_px;
  int failures = 0;
  for (const PredictedMarker& marker : markers) {
    const auto predicted = predictCorners(*marker.marker, camera, confirmed.prediction);
    if (!predicted) continue;
    const auto detection =
        detector.confirm(gray, {marker.marker->family, marker.marker->id, predicted->corners_px,
                                predicted->sigma_px, blur_sigma_px});
    if (detection && isThere(*detection, marker)) {
      correct(confirmed.prediction, *predicted, *detection);
      blur_sigma_px = detection->blur_sigma_px;
      confirmed.detections.push_back(*detection);
    } else if (++failures == kLargestFailures && confirmed.detections.empty()) {
      break;  // the prediction is no good
    }
  }
  return confirmed;
}

/// Whether a marker must be cut off by the image's border.
bool isCutOff(const Marker& marker, const CameraModel& camera, const PanelPrediction& prediction) {
  const auto predicted = predictCorners(marker, camera, prediction);
  if (!predicted) return true;
  const double margin_px = kSigmas * predicted->sigma_px;
  return std::any_of(predicted->corners_px.begin(), predicted->corners_px.end(), [&](const Vector2d& corner) {
    return std::min(corner.x(), corner.y()) < -margin_px || corner.x() > camera.width_px - 1 + margin_px ||
           corner.y() > camera.height_px - 1 + margin_px;
  });
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
  const cv::Mat gray = toGray(image);
  const auto markers = predictMarkers(map, camera, prediction);
  auto [detections, corrected] = confirmInTurn(detector, gray, map, camera, prediction, markers);

  auto missed = missedOf(markers, detections);
  if (!detections.empty())
    std::erase_if(missed, [&, &pose = corrected](const PredictedMarker& marker) {
      return isCutOff(*marker.marker, camera, pose);
    });
  for (const bool at_full_scale : {false, true}) {
    std::vector<SearchRegion> regions = searchRegions(missed);
    if (at_full_scale)  // with all the whole image would get
      for (SearchRegion& region : regions) region.smallest_side_px = 0;
    if (regions.empty()) break;
    for (const Detection& detection : expectedOnly(detector.detect(gray, regions), missed))
      detections.push_back(detection);
    missed = missedOf(missed, detections);
  }
  std::sort(detections.begin(), detections.end(), comesBefore);
  return detections;
}

}  // namespace fathom
