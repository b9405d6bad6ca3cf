#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "imaging/camera_geometry.h"

namespace fathom {

/// One number of a camera that a calibration finds.
struct CameraUnknown {
  std::string_view name, unit;
  /// Standard deviation of what is known of it before; 0: nothing. Wide: it keeps apart what views alone do
  /// not tell.
  double prior_sigma = 0;
};
inline constexpr std::size_t kCameraUnknowns = 19;
/// Of all kinds of cameras: the lens, the distance and tilt of a flat port, the place and size of a dome.
const std::array<CameraUnknown, kCameraUnknowns>& cameraUnknowns();
using CameraValues = Eigen::Matrix<double, kCameraUnknowns, 1>;

/// What a camera may be taken for: a lens, and what is before it under water.
struct CameraKind {
  enum class Port { none, flat, dome };
  std::string_view id;
  LensModel lens{};
  Port port = Port::none;
  std::string_view text{};
};
/// From the simplest on.
std::span<const CameraKind> cameraKinds();
/// Nothing where there is none.
const CameraKind* findCameraKind(std::string_view id);

/// Those of cameraUnknowns() that a camera of this kind has, by their places; the port's only where some
/// views are under water.
std::vector<std::size_t> unknownsOf(const CameraKind& kind, bool has_water);

/// The size of the images, and the glass before the camera.
struct CameraSetting {
  int width_px = 640, height_px = 480;
  double glass_m = 0.005;  ///< thickness of a port
};

/// The camera of these values (in the order of cameraUnknowns()) as it sees under water, or in air, where a
/// port bends nothing: a flat one's glass shifts lines of sight by less than a third of its thickness.
/// Intrinsics are those in air where the camera has a port.
template <class T>
CameraProjector<T> projectorOf(const T* values, const CameraKind& kind, const CameraSetting& setting,
                               bool in_water) {
  CameraProjector<T> camera;
  camera.lens = {values[0], values[1], values[2], values[3],  values[4],  values[5], values[6],
                 values[7], values[8], values[9], values[10], values[11], kind.lens};
  camera.height_px = setting.height_px;
  if (!in_water) return camera;
  if (kind.port == CameraKind::Port::flat)
    camera.port = {true,
                   values[12],
                   T(setting.glass_m),
                   values[13] * T(radians(1.0)),
                   values[14] * T(radians(1.0)),
                   T(kWaterIndex - 1),
                   T(0),
                   T(0),
                   T(0)};
  if (kind.port == CameraKind::Port::dome)
    camera.dome = {true, Vector3<T>(values[15], values[16], values[17]), values[18], T(setting.glass_m)};
  return camera;
}

/// Pinhole and lens alone.
CameraModel lensOf(const CameraValues& values, const CameraKind& kind, const CameraSetting& setting);

}  // namespace fathom
