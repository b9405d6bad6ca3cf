#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/geometry.h"

/// A camera's lens and pixels. Camera frame: x right, y down, z forward. Pixel (0, 0) is the centre of the
/// top left pixel, as in OpenCV.
namespace fathom {

template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
using Eigen::Vector2d;

/// What becomes of ideal image coordinates (x/z, y/z).
enum class LensModel {
  plumb_bob,  ///< Brown 1966, in OpenCV's notation: k1, k2, p1, p2, k3
  rational,   ///< OpenCV's and ROS's: the same over 1 + k4 r² + k5 r⁴ + k6 r⁶
  fisheye     ///< Kannala & Brandt 2006, as OpenCV's fisheye and ROS's equidistant: k1, k2, k3, k4
};

/// Which colour each pixel measures, by the first two pixels of the first two rows; none: each pixel all of
/// them.
enum class BayerPattern { none, rggb, grbg, gbrg, bggr };

/// Ideal image coordinates to distorted ones. C has the coefficients k1, k2, p1, p2, k3, k4, k5, k6 and which
/// of them count: `lens`.
template <class T, class C>
Vector2<T> distorted(const C& c, const Vector2<T>& ideal) {
  const T &x = ideal.x(), &y = ideal.y();
  const T r2 = x * x + y * y;
  if (c.lens == LensModel::fisheye) {
    using std::atan, std::sqrt;
    if (r2 < 1e-14) return ideal;  // atan(r)/r is 1 to rounding, and has no derivative as it stands
    const T r = sqrt(r2), angle = atan(r), a2 = angle * angle;
    const T bent = angle * (1.0 + a2 * (T(c.k1) + a2 * (T(c.k2) + a2 * (T(c.k3) + a2 * T(c.k4)))));
    return ideal * (bent / r);
  }
  T radial = 1.0 + r2 * (T(c.k1) + r2 * (T(c.k2) + r2 * T(c.k3)));
  if (c.lens == LensModel::rational) radial /= 1.0 + r2 * (T(c.k4) + r2 * (T(c.k5) + r2 * T(c.k6)));
  return {x * radial + 2.0 * T(c.p1) * x * y + T(c.p2) * (r2 + 2.0 * x * x),
          y * radial + T(c.p1) * (r2 + 2.0 * y * y) + 2.0 * T(c.p2) * x * y};
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
  double k4{}, k5{}, k6{};
  LensModel lens{};
  BayerPattern bayer{};
  bool above_water{};  ///< in air, above a flat surface of water; a pinhole sees straight through it too

  /// Ideal image coordinates (x/z, y/z) to distorted ones.
  template <class T>
  Vector2<T> distort(const Vector2<T>& ideal) const {
    return distorted(*this, ideal);
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

/// A lens's coefficients by the names they have in files, in the order of OpenCV's lists.
struct LensCoefficient {
  const char* name;
  double CameraModel::*value;
};
std::span<const LensCoefficient> coefficientsOf(LensModel lens);
/// "plumb_bob", …, as in files.
std::string_view nameOf(LensModel lens);
std::optional<LensModel> lensNamed(std::string_view name);
/// The colour that a pixel measures: 0 red, 1 green, 2 blue; -1: all of them.
int colourAt(BayerPattern pattern, int column, int row);
/// How many pixels come to one that measures a colour (0 red, 1 green, 2 blue): by so much fewer tell of it.
double pixelsPerMeasured(BayerPattern pattern, int colour);
/// "rggb", …, as in files; none has no name.
std::optional<BayerPattern> bayerNamed(std::string_view name);
/// "k1: 0.1, …", of a fisheye "model: fisheye, k1: …": as a vehicle file has it.
std::string distortionText(const CameraModel& camera);

}  // namespace fathom
