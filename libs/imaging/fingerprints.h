#pragma once

#include <string>

#include "core/fingerprint.h"
#include "imaging/water.h"
#include "panel/panel_map.h"
#include "sensors/vehicle.h"

/// What tells inputs apart, so that results which were kept are not taken for those of others.
namespace fathom {

void add(Fingerprint& fingerprint, const Pose& pose);
void add(Fingerprint& fingerprint, const CameraModel& camera);

std::string fingerprintOf(const CameraModel& camera);
/// What images depend on, but for where the camera is.
std::string fingerprintOf(const CameraSheet& sheet);
std::string fingerprintOf(const std::vector<LampSheet>& lamps);
std::string fingerprintOf(const Environment& environment);
std::string fingerprintOf(const Surface& surface);
std::string fingerprintOf(const PanelMap& map);  ///< its body and mesh included

}  // namespace fathom
