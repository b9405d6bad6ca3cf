#include "calibration/camera_kinds.h"

#include <algorithm>

namespace fathom {
namespace {

using Port = CameraKind::Port;

constexpr std::array<CameraKind, 5> kKinds{
    {{"pinhole", LensModel::plumb_bob, Port::none, "pinhole, plumb-bob distortion"},
     {"fisheye", LensModel::fisheye, Port::none, "Kannala and Brandt's fisheye"},
     {"rational", LensModel::rational, Port::none, "pinhole, rational distortion"},
     {"flat-port", LensModel::plumb_bob, Port::flat, "pinhole in air behind a flat port"},
     {"dome-port", LensModel::plumb_bob, Port::dome, "pinhole in air behind a dome"}}};

void append(std::vector<std::size_t>& places, std::size_t from, std::size_t to) {
  for (std::size_t place = from; place < to; ++place) places.push_back(place);
}

}  // namespace

const std::array<CameraUnknown, kCameraUnknowns>& cameraUnknowns() {
  static constexpr std::array<CameraUnknown, kCameraUnknowns> all{{{"fx_px", "px"},
                                                                   {"fy_px", "px"},
                                                                   {"cx_px", "px"},
                                                                   {"cy_px", "px"},
                                                                   {"k1", "1", 1},
                                                                   {"k2", "1", 1},
                                                                   {"p1", "1", 0.1},
                                                                   {"p2", "1", 0.1},
                                                                   {"k3", "1", 1},
                                                                   {"k4", "1", 1},
                                                                   {"k5", "1", 1},
                                                                   {"k6", "1", 1},
                                                                   {"distance_m", "m", 0.05},
                                                                   {"tilt_deg", "deg", 2},
                                                                   {"tilt_y_deg", "deg", 2},
                                                                   {"centre_x_m", "m", 0.02},
                                                                   {"centre_y_m", "m", 0.02},
                                                                   {"centre_z_m", "m", 0.02},
                                                                   {"log_radius", "1", 0.4}}};
  return all;
}

std::span<const CameraKind> cameraKinds() { return kKinds; }

const CameraKind* findCameraKind(std::string_view id) {
  const auto* found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const CameraKind& k) { return k.id == id; });
  return found == kKinds.end() ? nullptr : found;
}

std::vector<std::size_t> unknownsOf(const CameraKind& kind, bool has_water) {
  std::vector<std::size_t> places;
  append(places, 0, 6);
  if (kind.lens != LensModel::fisheye) append(places, 6, 9);
  if (kind.lens == LensModel::fisheye) append(places, 8, 10);
  if (kind.lens == LensModel::rational) append(places, 9, 12);
  if (has_water && kind.port == Port::flat) append(places, 12, 15);
  if (has_water && kind.port == Port::dome) append(places, 15, 19);
  return places;
}

CameraModel lensOf(const CameraValues& values, const CameraKind& kind, const CameraSetting& setting) {
  CameraModel size;
  size.width_px = setting.width_px;
  size.height_px = setting.height_px;
  return projectorOf(values.data(), kind, setting, false).lensModel(size);
}

}  // namespace fathom
