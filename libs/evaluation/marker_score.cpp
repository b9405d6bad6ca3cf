#include "evaluation/marker_score.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "evaluation/statistics.h"
#include "observables/views.h"

namespace fathom {
namespace {

constexpr double kNearest_m = 0.05;
constexpr int kSamplesAlongSide = 16;  // closer together than any handle is thick
/// So many of them may be hidden, at random: far off, several see the same pixel of an edge.
constexpr int kHiddenSamples = 2;
/// What hides a marker stands out by more; the plate around it, which a pixel at its edge may see, by less.
constexpr double kInFront_m = 0.02;

/// Whether the camera sees something nearer than the marker through a pixel.
bool isHiddenAt(int column, int row, const Pose& T_camera_marker, const CameraProjector<double>& projector,
                const cv::Mat& range_m) {
  const auto [origin, ray] = projector.lineOfSight({double(column), double(row)});
  const Vector3d normal = T_camera_marker.rotation.col(2);
  const double way_m = normal.dot(T_camera_marker.position - origin) / normal.dot(ray);
  const double expected_m = (origin + way_m * ray).norm();
  return range_m.at<float>(row, column) < expected_m - kInFront_m;
}

bool isHidden(const Marker& marker, const Pose& T_camera_panel, const CameraProjector<double>& projector,
              const cv::Mat& range_m) {
  if (range_m.empty()) return false;
  const Pose T_camera_marker = T_camera_panel * marker.T_panel_marker;
  const auto offset = [&](int i) { return marker.size_m * ((i + 0.5) / kSamplesAlongSide - 0.5); };
  int hidden = 0;
  for (int i = 0; i < kSamplesAlongSide; ++i)
    for (int j = 0; j < kSamplesAlongSide; ++j) {
      const Vector2d pixel = projector.project<double>(T_camera_marker * Vector3d(offset(i), offset(j), 0));
      const int column = std::clamp(int(std::lround(pixel.x())), 0, range_m.cols - 1);
      const int row = std::clamp(int(std::lround(pixel.y())), 0, range_m.rows - 1);
      hidden += isHiddenAt(column, row, T_camera_marker, projector, range_m) ? 1 : 0;
    }
  return hidden > kHiddenSamples;
}

bool isOf(const Detection& detection, const Marker& marker) {
  return detection.family == marker.family && detection.id == marker.id;
}

double farthestCorner_px(const Detection& detection, const MarkerPlace& place) {
  double farthest = 0;
  for (std::size_t k = 0; k < 4; ++k)
    farthest = std::max(farthest, (detection.corners_px[k] - place.corners_px[k]).norm());
  return farthest;
}

}  // namespace

std::vector<MarkerPlace> placesOf(const PanelMap& map, const CameraModel& camera, const Pose& T_camera_panel,
                                  const cv::Mat& range_m) {
  return placesOf(map, camera, CameraProjector<double>::nominal(camera), T_camera_panel, range_m);
}

std::vector<MarkerPlace> placesOf(const PanelMap& map, const CameraModel& camera,
                                  const CameraProjector<double>& projector, const Pose& T_camera_panel,
                                  const cv::Mat& range_m) {
  std::vector<MarkerPlace> places;
  for (const Marker& marker : map.markers) {
    MarkerPlace place{&marker};
    const auto corners_panel = marker.corners_panel();
    bool in_front = true;
    for (std::size_t k = 0; k < 4 && in_front; ++k) {
      const Vector3d corner = T_camera_panel * corners_panel[k];
      in_front = corner.z() > kNearest_m;
      place.corners_px[k] = projector.project(corner);
    }
    if (!in_front) continue;
    place.visible = isWhole(marker, camera, projector, T_camera_panel.inverse()) &&
                    !isHidden(marker, T_camera_panel, projector, range_m);
    places.push_back(place);
  }
  return places;
}

ImageScore scoreDetections(const std::vector<Detection>& detections, const std::vector<MarkerPlace>& places,
                           double tolerance_px) {
  ImageScore score;
  std::vector<const Detection*> right;  // those that show a marker in its place
  for (const MarkerPlace& place : places) {
    score.visible += place.visible ? 1 : 0;
    const Detection* nearest = nullptr;
    for (const Detection& detection : detections) {
      if (!isOf(detection, *place.marker) || farthestCorner_px(detection, place) > tolerance_px) continue;
      if (nearest == nullptr || farthestCorner_px(detection, place) < farthestCorner_px(*nearest, place))
        nearest = &detection;
    }
    if (nearest == nullptr) continue;
    right.push_back(nearest);
    if (!place.visible) continue;
    ++score.found;
    for (std::size_t k = 0; k < 4; ++k)
      score.squares_px2 += (nearest->corners_px[k] - place.corners_px[k]).squaredNorm();
  }
  score.wrong = static_cast<int>(detections.size() - right.size());
  for (const Detection& detection : detections)
    score.unknown += std::none_of(places.begin(), places.end(),
                                  [&](const MarkerPlace& place) { return isOf(detection, *place.marker); });
  return score;
}

void scorePose(const std::vector<Detection>& detections, const PanelMap& map, const CameraModel& camera,
               const Pose& T_camera_panel, ImageScore& score) {
  const PanelPoseEstimate estimate = solvePanelPose(detections, map, camera);
  score.posed = estimate.solved;
  if (!estimate.solved) return;
  const Pose& solved = estimate.T_camera_panel.pose;
  score.position_error_m = (solved.position - T_camera_panel.position).norm();
  score.angle_error_rad = angleBetween(solved.rotation, T_camera_panel.rotation);
}

std::pair<double, double> wilsonInterval(std::size_t hits, std::size_t count) {
  if (count == 0) return {0.0, 1.0};
  constexpr double z = 1.959963984540054;  // of the standard normal, 97.5 %
  const auto n = static_cast<double>(count);
  const double rate = static_cast<double>(hits) / n;
  const double centre = rate + z * z / (2 * n),
               spread = z * std::sqrt((rate * (1 - rate) + z * z / (4 * n)) / n);
  const double scale = 1 + z * z / n;
  return {std::max(0.0, (centre - spread) / scale), std::min(1.0, (centre + spread) / scale)};
}

void ScoreTally::add(const ImageScore& score) {
  ++images_;
  visible_ += static_cast<std::size_t>(score.visible);
  found_ += static_cast<std::size_t>(score.found);
  wrong_ += static_cast<std::size_t>(score.wrong);
  unknown_ += static_cast<std::size_t>(score.unknown);
  squares_px2_ += score.squares_px2;
  if (!score.posed) return;
  position_errors_m_.push_back(score.position_error_m);
  angle_errors_rad_.push_back(score.angle_error_rad);
}

double ScoreTally::detectionRate() const {
  return visible_ == 0 ? std::numeric_limits<double>::quiet_NaN()
                       : static_cast<double>(found_) / static_cast<double>(visible_);
}

double ScoreTally::cornerRms_px() const {
  return found_ == 0 ? std::numeric_limits<double>::quiet_NaN()
                     : std::sqrt(squares_px2_ / (4.0 * static_cast<double>(found_)));
}

double ScoreTally::medianPositionError_m() const { return summaryOf(position_errors_m_).median; }
double ScoreTally::medianAngleError_rad() const { return summaryOf(angle_errors_rad_).median; }

}  // namespace fathom
