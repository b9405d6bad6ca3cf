#pragma once

#include <filesystem>
#include <string>

#include "simulation/navigation_simulator.h"

namespace fathom {

/// Where a simulated recording goes and what its first comment says.
struct RecordingTarget {
  std::filesystem::path folder;
  std::string name;                    ///< NAME.rawlog, NAME_vehicle.yaml, NAME_truth.tum
  std::filesystem::path vehicle_file;  ///< the file options.vehicle was read from; copied beside the rawlog
  std::string panel_map;               ///< path relative to the folder, or empty
  std::string description;
};

struct RecordingFiles {
  std::filesystem::path rawlog, vehicle, truth;
};

/// Simulates a whole recording in the form of the recording convention. Memory does not depend on its
/// length. Files appear under their names only when whole; the rawlog, last. Throws Error; Interrupted.
RecordingFiles simulateRecording(const SimulationOptions& options, const Trajectory& trajectory,
                                 const RecordingTarget& target);

}  // namespace fathom
