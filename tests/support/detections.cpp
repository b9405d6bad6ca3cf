#include "support/detections.h"

namespace fathom::test {

PanelMap gridPanel(int columns, int rows, int first_id) {
  PanelMap map;
  map.name = "grid " + std::to_string(first_id);
  int k = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column, ++k)
      map.markers.push_back(markerAt("DICT_ARUCO_ORIGINAL", first_id + k, 0.18,
                                     0.45 * (column - 0.5 * (columns - 1)), 0.36 * (row - 0.5 * (rows - 1)),
                                     radians(90) * (k % 4)));
  map.setExtent();
  return map;
}

Matrix8d cornerCovariance(double sigma_px) {
  Matrix8d C = Matrix8d::Identity();
  for (Eigen::Index i = 0; i < 8; ++i) C(i, (i + 2) % 8) = C((i + 2) % 8, i) = -0.3;
  return sigma_px * sigma_px * C;
}

std::vector<Detection> detectionsOf(const PanelMap& map, const CameraModel& camera,
                                    const Pose& T_camera_panel, double sigma_px, Random& random) {
  const Matrix8d C = cornerCovariance(sigma_px);
  const Matrix8d root = C.llt().matrixL();
  std::vector<Detection> detections;
  for (const Marker& marker : map.markers) {
    Detection detection;
    detection.family = marker.family;
    detection.id = marker.id;
    detection.corners_px = trueCorners(marker, camera, T_camera_panel);
    detection.covariance_px2 = C;
    Vector8d noise;
    for (Eigen::Index i = 0; i < 8; ++i) noise[i] = random.normal();
    noise = root * noise;
    for (std::size_t k = 0; k < 4; ++k)
      detection.corners_px[k] += noise.segment<2>(static_cast<Eigen::Index>(2 * k));
    detections.push_back(detection);
  }
  return detections;
}

Vector6d poseError(const Pose& estimate, const Pose& truth) {
  Vector6d error;
  error.head<3>() = truth.position - estimate.position;
  error.tail<3>() = logSO3<double>(estimate.rotation.transpose() * truth.rotation);
  return error;
}

}  // namespace fathom::test
