#pragma once

#include <vector>

#include "core/random.h"
#include "panel/panel_map.h"

namespace fathom {

/// A sea floor at odom z = sea_floor_z_m, its middle below that of the panels; odom frame. The same random
/// numbers give the same sand. There must be a panel.
Surface seaFloorBelow(const std::vector<PanelMap>& panels, double sea_floor_z_m, Random sand);

/// The panels on a sea floor at odom z = sea_floor_z_m, see seaFloorBelow(); odom frame.
Surface sceneOf(const std::vector<PanelMap>& panels, double sea_floor_z_m, Random sand);
Surface sceneOf(const std::vector<PanelMap>& panels, const Surface& sea_floor_odom);

}  // namespace fathom
