#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/random.h"
#include "imaging/water.h"
#include "simulation/navigation_simulator.h"

namespace fathom {

/// Where a simulated recording goes, what its first comment says, and what its camera sees.
struct RecordingTarget {
  std::filesystem::path folder;
  std::string name;                    ///< NAME.rawlog, NAME_vehicle.yaml, NAME_truth.tum, …
  std::filesystem::path vehicle_file;  ///< the file options.vehicle was read from; copied beside the rawlog
  /// One panel's or a list's (panel/panel_maps.h); copied to NAME_panel/, with meshes. Empty: no panel.
  std::filesystem::path panel_map;
  std::string description;
  std::optional<Environment> environment;  ///< with it, a panel map and a camera there are images
};

struct RecordingFiles {
  std::filesystem::path rawlog, vehicle, truth;
  std::filesystem::path panel_map;  ///< empty: none
  std::filesystem::path images;     ///< the folder; empty: none
  std::size_t image_entries = 0;    ///< CAMERA or STEREO
};

/// Random numbers of the sand on a simulated recording's sea floor (render/scene.h).
Random sandOf(std::uint64_t seed);

/// Simulates a whole recording in the form of the recording convention. Memory does not depend on its
/// length. Files appear under their names only when whole; the rawlog, last: it tells that all is there.
/// Images that an interrupted run has made are not made again: see image_simulator.h. Throws Error;
/// Interrupted.
RecordingFiles simulateRecording(const SimulationOptions& options, const Trajectory& trajectory,
                                 const RecordingTarget& target);

}  // namespace fathom
