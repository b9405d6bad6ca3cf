#pragma once

#include <string>

#include "panel/panel_map.h"
#include "sensors/vehicle.h"

/// What tells inputs of evaluations apart, see chunk_store.h.
namespace fathom {

std::string fingerprintOf(const CameraModel& camera);
std::string fingerprintOf(const CameraSheet& sheet);  ///< what images depend on
std::string fingerprintOf(const PanelMap& map);       ///< its body and mesh included

}  // namespace fathom
