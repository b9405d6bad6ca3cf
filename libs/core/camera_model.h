#pragma once

#include "core/geometry.h"

/// Pinhole camera with plumb-bob distortion (Brown 1966, in OpenCV's notation). Camera frame: x right, y
/// down, z forward. Pixel (0, 0) is the centre of the top left pixel, as in OpenCV.
namespace fathom {

template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
using Eigen::Vector2d;

/// Plumb-bob distortion: ideal image coordinates (x/z, y/z) to distorted ones.
template <class T, class Coefficient>
Vector2<T> plumbBob(const Vector2<T>& ideal, const Coefficient& k1, const Coefficient& k2,
                    const Coefficient& p1, const Coefficient& p2, const Coefficient& k3) {
  const T &x = ideal.x(), &y = ideal.y();
  const T r2 = x * x + y * y;
  const T radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

/// Where a flat window before a camera is: its distance along its normal, which is Exp(tilt_x, tilt_y, 0) z
/// in the camera's frame. A pinhole sees straight through it; what it does to light is an effect.
struct Window {
  double distance_m = 0, tilt_x_rad = 0, tilt_y_rad = 0;

  friend bool operator==(const Window&, const Window&) = default;
};

struct CameraModel {
  int width_px = 640, height_px = 480;
  double fx_px = 500, fy_px = 500, cx_px = 319.5, cy_px = 239.5;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  Window window{};

  /// Ideal image coordinates (x/z, y/z) to distorted ones.
  template <class T>
  Vector2<T> distort(const Vector2<T>& ideal) const {
    return plumbBob(ideal, k1, k2, p1, p2, k3);
  }

  /// A point in front of the camera (z > 0), camera frame, to its pixel.
  template <class T>
  Vector2<T> project(const Vector3<T>& point_camera) const {
    const Vector2<T> d =
        distort(Vector2<T>(point_camera.x() / point_camera.z(), point_camera.y() / point_camera.z()));
    return {fx_px * d.x() + cx_px, fy_px * d.y() + cy_px};
  }

  /// The inverse: ideal image coordinates (x/z, y/z) seen at a pixel, to 1e-12 where the distortion is
  /// invertible (Gauss-Newton on distort()).
  Vector2d idealAt(const Vector2d& pixel) const;

  /// The direction of sight at a pixel, camera frame, unit length.
  Vector3d rayAt(const Vector2d& pixel) const { return idealAt(pixel).homogeneous().normalized(); }

  /// Whether a pixel position lies in the image.
  bool contains(const Vector2d& pixel) const {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width_px - 0.5 &&
           pixel.y() < height_px - 0.5;
  }

  friend bool operator==(const CameraModel&, const CameraModel&) = default;
};

}  // namespace fathom
