#include "fiducials/single_marker_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "core/stable_sort.h"

namespace fathom {
namespace {

Pose fromOpenCv(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  const auto vector = [](const cv::Mat& m) {
    return Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
  };
  return {expSO3<double>(vector(rotation_vector)), vector(translation)};
}

/// In the camera's ideal image, so that neither distortion nor focal lengths matter. OpenCV throws where the
/// points are degenerate; such candidates are none.
std::vector<Pose> solve(const std::vector<cv::Point3d>& points, const std::vector<Vector2d>& pixels,
                        const CameraModel& camera, cv::SolvePnPMethod method) {
  std::vector<cv::Point2d> ideal;
  for (const Vector2d& pixel : pixels) {
    const Vector2d p = camera.idealAt(pixel);
    if (!p.allFinite()) return {};
    ideal.emplace_back(p.x(), p.y());
  }
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(points, ideal, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations,
                        false, method);
  } catch (const cv::Exception&) {
    return {};
  }
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Pose pose = fromOpenCv(rotations[i], translations[i]);
    if (pose.position.allFinite() && pose.rotation.allFinite() && pose.position.z() > 0)
      poses.push_back(pose);
  }
  return poses;
}

/// Of the square that is nearest to a marker's corners: on a panel that is bent it leans.
Pose nearestSquare(const Marker& marker) {
  if (marker.off_square_m.isZero()) return marker.T_panel_marker;
  Eigen::Matrix<double, 3, 4> square, there;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const auto& [right, up] = kMarkerCorners[static_cast<std::size_t>(k)];
    square.col(k) = 0.5 * marker.size_m * Vector3d(right, up, 0);
    there.col(k) = marker.corners_panel()[static_cast<std::size_t>(k)];
  }
  const Eigen::Matrix4d T = Eigen::umeyama(square, there, false);
  return {T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>()};
}

}  // namespace

std::vector<MarkerPose> poseOfMarker(const Detection& detection, double size_m, const CameraModel& camera) {
  const double half = size_m / 2;
  std::vector<cv::Point3d> square;
  for (const auto& [right, up] : kMarkerCorners) square.emplace_back(half * right, half * up, 0);
  const std::vector<Vector2d> pixels(detection.corners_px.begin(), detection.corners_px.end());
  std::vector<MarkerPose> poses;
  for (const Pose& pose : solve(square, pixels, camera, cv::SOLVEPNP_IPPE_SQUARE)) {
    double squares = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3d corner = pose * Vector3d(square[k].x, square[k].y, 0);
      squares += (camera.project(corner) - pixels[k]).squaredNorm();
    }
    poses.push_back({pose, std::sqrt(squares / 8.0)});
  }
  stableSort(poses, [](const MarkerPose& a, const MarkerPose& b) { return a.rms_px < b.rms_px; });
  return poses;
}

std::vector<Pose> poseOfPlane(const std::vector<Vector2d>& points_m, const std::vector<Vector2d>& pixels,
                              const CameraModel& camera) {
  std::vector<cv::Point3d> points;
  points.reserve(points_m.size());
  for (const Vector2d& point : points_m) points.emplace_back(point.x(), point.y(), 0);
  return solve(points, pixels, camera, cv::SOLVEPNP_IPPE);
}

const Marker* markerOf(const Detection& detection, const PanelMap& map) {
  for (const Marker& marker : map.markers)
    if (marker.id == detection.id && marker.family == detection.family) return &marker;
  return nullptr;
}

std::optional<Pose> meanOfMarkers(const std::vector<Detection>& detections, const PanelMap& map,
                                  const CameraModel& camera) {
  std::optional<Pose> mean;
  double count = 0;
  for (const Detection& detection : detections) {
    const Marker* marker = markerOf(detection, map);
    if (marker == nullptr) continue;
    const auto poses = poseOfMarker(detection, marker->size_m, camera);
    if (poses.empty()) continue;
    const Pose T_camera_panel = poses.front().T_camera_marker * nearestSquare(*marker).inverse();
    count += 1;
    if (!mean) mean = T_camera_panel;
    mean->position += (T_camera_panel.position - mean->position) / count;
    mean->rotation = slerp(mean->rotation, T_camera_panel.rotation, 1.0 / count);
  }
  return mean;
}

Matrix3d slerp(const Matrix3d& R1, const Matrix3d& R2, double share) {
  return R1 * expSO3<double>(share * logSO3<double>(R1.transpose() * R2));
}

}  // namespace fathom
