#pragma once

#include "environment/water_study.h"
#include "support/sil_recordings.h"

/// Images of a simulated recording in known water, to be rendered again.
namespace fathom::test {

struct WaterImages {
  PosedImages images;
  KnownWorld world = silWorld();
  std::vector<std::size_t> nearest;  ///< so many, which have the most patches

  WaterImages(const std::string& name, std::size_t count) {
    SimulationOptions options;
    options.vehicle = readVehicle(kConfig / "trial_rov.yaml");
    options.duration_s = 45;
    const RecordingFiles recording =
        simulateRecording(options, readTrajectory(kConfig / "trial_trajectory.yaml"),
                          {std::filesystem::temp_directory_path() / name, "bench", kConfig / "trial_rov.yaml",
                           kDexrovMap, "a bench", readEnvironment(kSilWater)});
    images = posedImages(recording.rawlog, {}, readPanelMaps(kDexrovMap), silDetection());
    world.vehicle = options.vehicle;
    for (std::size_t i = images.posed.size() - count; i < images.posed.size(); ++i) nearest.push_back(i);
  }
  PairMaker maker() const { return {world, {}, silDetection()}; }
};

}  // namespace fathom::test
