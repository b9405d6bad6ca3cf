#pragma once

#include <optional>
#include <vector>

#include "calibration/camera_fit.h"

namespace fathom::test {

/// A camera before boards, whose light is traced (traced_light.h): pixels at random, and where what is seen
/// there is on the board.
struct BoardViews {
  CameraModel lens{.width_px = 1280,
                   .height_px = 960,
                   .fx_px = 1100,
                   .fy_px = 1105,
                   .cx_px = 650,
                   .cy_px = 470,
                   .k1 = -0.12,
                   .k2 = 0.05,
                   .p1 = 0.001,
                   .p2 = -0.0015,
                   .k3 = -0.01};
  std::optional<FlatPort<double>> port{};  ///< before it under water
  std::optional<DomePort<double>> dome{};
  double noise_px = 0.1, nearest_m = 0.4, farthest_m = 1.5;
  int points = 40;

  CameraSetting setting() const { return {.width_px = lens.width_px, .height_px = lens.height_px}; }
  std::vector<BoardView> views(int count, bool in_water, std::uint64_t seed) const;
};

}  // namespace fathom::test
