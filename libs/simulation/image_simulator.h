#pragma once

#include <filesystem>

#include "simulation/camera_studio.h"
#include "simulation/navigation_simulator.h"

namespace fathom {

/// How many images a simulation takes. Throws Error where begin or duration lie outside the trajectory.
std::size_t imageCount(const SimulationOptions& options, const Trajectory& trajectory);

/// Takes image k as CameraStudio has it, with the effects that are on at the time of its entry (imageTime):
/// the robot's pose is the one at that time, or by a latency another, at most the trajectory's ends. Writes
/// it to `folder` under its name (imageFiles), all cores at once. Both cameras of a stereo pair are of the
/// same kind. The noise depends on seed, image and eye only.
///
/// Goes on where an earlier run was cut short: an image is left alone where it is there, whole, and belongs
/// to the same inputs (ImageStore). Otherwise images begin anew. The result is the same, byte by byte,
/// however often it was interrupted and on however many cores it ran.
///
/// Throws Error, Interrupted; std::invalid_argument where the vehicle has no camera.
void simulateImages(const SimulationOptions& options, const Trajectory& trajectory, const CameraWorld& world,
                    const std::filesystem::path& folder);

}  // namespace fathom
