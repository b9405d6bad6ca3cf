#include "support/marker_images.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "panel/marker_family.h"

namespace fathom::test {
namespace {

/// A marker with the inverse of its placement, so that a point of its plane finds its cell.
struct DrawnMarker {
  MarkerPattern pattern;
  double cell_m;

  explicit DrawnMarker(const Marker& marker)
      : pattern(markerPattern(marker.family, marker.id)), cell_m(marker.size_m / pattern.border_cells) {}

  /// Brightness at a point of the marker's plane; `behind` outside its quiet zone of one cell.
  double at(double x, double y, const Look& look, double behind) const {
    const double half = 0.5 * pattern.cells;
    const double column = x / cell_m + half, row = half - y / cell_m;
    if (column < -1 || row < -1 || column >= pattern.cells + 1 || row >= pattern.cells + 1) return behind;
    if (column < 0 || row < 0 || column >= pattern.cells || row >= pattern.cells) return look.white;
    return pattern.whiteAt(static_cast<int>(row), static_cast<int>(column)) ? look.white : look.black;
  }
};

cv::Rect boundingBox(const Marker& marker, double cell_m, const CameraModel& camera,
                     const Pose& T_camera_panel) {
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  const double half = 0.5 * marker.size_m + 3.5 * cell_m;
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) {
      const Vector3d point =
          T_camera_panel * (marker.T_panel_marker * Vector3d(half * (i / 4.0 - 1), half * (j / 4.0 - 1), 0));
      const Vector2d pixel = camera.project(point);
      low_x = std::min(low_x, pixel.x()), high_x = std::max(high_x, pixel.x());
      low_y = std::min(low_y, pixel.y()), high_y = std::max(high_y, pixel.y());
    }
  const cv::Rect box(
      cv::Point(static_cast<int>(std::floor(low_x)) - 1, static_cast<int>(std::floor(low_y)) - 1),
      cv::Point(static_cast<int>(std::ceil(high_x)) + 2, static_cast<int>(std::ceil(high_y)) + 2));
  return box & cv::Rect(0, 0, camera.width_px, camera.height_px);
}

/// `count` equally likely offsets from a pixel's centre, px: the pixel's box blurred by a Gaussian. (Blurring
/// the image instead would make a point spread of steps.)
std::vector<double> sampleOffsets(double blur_sigma_px, int count) {
  const double sigma = std::max(blur_sigma_px, 1e-6);
  const auto integral = [](double z) {  // of the normal's cumulative distribution
    return z * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
           std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
  };
  const auto share_below = [&](double t) {
    return sigma * (integral((t + 0.5) / sigma) - integral((t - 0.5) / sigma));
  };
  std::vector<double> offsets;
  for (int k = 0; k < count; ++k) {
    double low = -1 - 6 * sigma, high = 1 + 6 * sigma;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (share_below(middle) < (k + 0.5) / count ? low : high) = middle;
    }
    offsets.push_back(0.5 * (low + high));
  }
  return offsets;
}
}  // namespace

cv::Mat drawMarkers(const std::vector<Marker>& markers, const CameraModel& camera, const Pose& T_camera_panel,
                    const Look& look, Random& random) {
  cv::Mat image(camera.height_px, camera.width_px, CV_32FC1, cv::Scalar(look.background));
  constexpr int kShifts = 16;  // each pixel takes its own sixteenth of the offsets: noise instead of steps
  const bool straight =
      camera.k1 == 0 && camera.k2 == 0 && camera.k3 == 0 && camera.p1 == 0 && camera.p2 == 0;
  const auto ideal_at = [&](double x, double y) -> Vector2d {
    if (straight) return {(x - camera.cx_px) / camera.fx_px, (y - camera.cy_px) / camera.fy_px};
    return camera.idealAt({x, y});
  };
  const int n = look.supersampling;
  const std::vector<double> offsets = sampleOffsets(look.blur_sigma_px, kShifts * n * n);
  for (const Marker& marker : markers) {
    const DrawnMarker drawn(marker);
    const Pose T_camera_marker = T_camera_panel * marker.T_panel_marker;
    // A ray (x y 1) meets the marker's plane at u/w, v/w, with (u v w) = to_plane (x y 1).
    Matrix3d plane = T_camera_marker.rotation;
    plane.col(2) = T_camera_marker.position;
    const Matrix3d to_plane = plane.inverse();
    const cv::Rect box = boundingBox(marker, drawn.cell_m, camera, T_camera_panel);
    for (int row = box.y; row < box.y + box.height; ++row)
      for (int column = box.x; column < box.x + box.width; ++column) {
        // The lens's distortion is linear within a pixel.
        const Vector2d ideal = ideal_at(column, row);
        const Vector2d by_column = ideal_at(column + 0.5, row) - ideal;
        const Vector2d by_row = ideal_at(column, row + 0.5) - ideal;
        const int shift_x = static_cast<int>(random.uniform(0, kShifts));
        const int shift_y = static_cast<int>(random.uniform(0, kShifts));
        const auto offset = [&](int sample, int shift) {
          return offsets[static_cast<std::size_t>(kShifts) * static_cast<std::size_t>(sample) +
                         static_cast<std::size_t>(shift)];
        };
        // Plain numbers: sanitizers look into every call of Eigen's.
        const Vector3d uvw = to_plane * ideal.homogeneous();
        const Vector3d uvw_by_x = to_plane.leftCols<2>() * by_column * 2.0;
        const Vector3d uvw_by_y = to_plane.leftCols<2>() * by_row * 2.0;
        const double here[] = {uvw[0], uvw[1], uvw[2]};
        const double along_x[] = {uvw_by_x[0], uvw_by_x[1], uvw_by_x[2]};
        const double along_y[] = {uvw_by_y[0], uvw_by_y[1], uvw_by_y[2]};
        const double behind = image.at<float>(row, column);
        double sum = 0;
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            // No two samples share a row or a column: edges along them are as smooth as others.
            const double x = offset(i * n + j, shift_x);
            const double y = offset(j * n + i, shift_y);
            const double u = here[0] + x * along_x[0] + y * along_y[0];
            const double v = here[1] + x * along_x[1] + y * along_y[1];
            const double w = here[2] + x * along_x[2] + y * along_y[2];
            sum += drawn.at(u / w, v / w, look, behind);
          }
        image.at<float>(row, column) = static_cast<float>(sum / (n * n));
      }
  }
  cv::Mat result(image.size(), CV_8UC1);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      result.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(
          image.at<float>(row, column) + (look.noise_sigma > 0 ? look.noise_sigma * random.normal() : 0.0));
  return result;
}

Marker markerAt(const std::string& family, int id, double size_m, double x, double y, double rotation) {
  Marker marker;
  marker.family = family;
  marker.id = id;
  marker.size_m = size_m;
  marker.T_panel_marker = {rotationFromYawPitchRoll(rotation, 0, 0), {x, y, 0}};
  return marker;
}

Pose lookingAtPanel(double distance_m, double tilt, double axis, double roll) {
  const Matrix3d facing = rotationFromYawPitchRoll(0, 0, std::numbers::pi);  // x right, y up, z to the camera
  const Vector3d turn = tilt * Vector3d(std::cos(axis), std::sin(axis), 0);
  return {rotationFromYawPitchRoll(roll, 0, 0) * facing * expSO3<double>(turn), {0, 0, distance_m}};
}

std::array<Vector2d, 4> trueCorners(const Marker& marker, const CameraModel& camera,
                                    const Pose& T_camera_panel) {
  std::array<Vector2d, 4> corners;
  const auto corners_panel = marker.corners_panel();
  for (std::size_t k = 0; k < 4; ++k) corners[k] = camera.project<double>(T_camera_panel * corners_panel[k]);
  return corners;
}

}  // namespace fathom::test
