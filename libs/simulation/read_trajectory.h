#pragma once

#include <filesystem>

#include "simulation/trajectory.h"

namespace fathom {

/// Reads a trajectory: NAME.yaml are waypoints (see waypoints.h), anything else is TUM text. Throws Error.
Trajectory readTrajectory(const std::filesystem::path& file);

}  // namespace fathom
