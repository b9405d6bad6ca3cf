#pragma once

#include <vector>

#include "core/random.h"
#include "panel/panel_map.h"

namespace fathom {

/// The panels on a sea floor at odom z = sea_floor_z_m, its middle below theirs; odom frame. The same random
/// numbers give the same sand. There must be a panel.
Surface sceneOf(const std::vector<PanelMap>& panels, double sea_floor_z_m, Random sand);

}  // namespace fathom
