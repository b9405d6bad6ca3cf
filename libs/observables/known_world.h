#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "effects/registry.h"
#include "imaging/water.h"
#include "panel/panel_map.h"
#include "sensors/vehicle.h"

namespace fathom {

/// A level sea floor of sand (render/scene.h).
struct KnownSeaFloor {
  double z_m = 0;  ///< in odom
  std::uint64_t sand_seed = 1;
};

/// What is known of the world that a recording's images show.
struct KnownWorld {
  Vehicle
      vehicle;  ///< must have a camera: its response and noise; mounting and intrinsics are the recording's
  std::vector<PanelMap> panels;
  Environment environment;
  EffectParameters<double> effects;
  std::optional<KnownSeaFloor> sea_floor;  ///< absent: the panels hang in endless water
};

/// The sea floor of a recording that `fathom simulate` made: it stands in NAME_simulation.json beside the
/// rawlog. Nothing where there is no such file. Throws Error where it is damaged.
std::optional<KnownSeaFloor> seaFloorOf(const std::filesystem::path& rawlog);

/// Its water and light, lamps off, from the same file. Nothing where there is none, or it had no images.
/// Throws Error likewise.
std::optional<Environment> trueEnvironment(const std::filesystem::path& rawlog);

}  // namespace fathom
