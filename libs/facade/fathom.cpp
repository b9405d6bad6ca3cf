#include "facade/fathom.h"

#include <algorithm>

#include "effects/calibration.h"
#include "sensors/vehicle.h"
#include "simulation/read_trajectory.h"
#include "tasks/sample_chain.h"
#include "tasks/start_pose.h"

namespace fathom {
namespace fs = std::filesystem;

BatchRecording openRecording(const fs::path& rawlog, const RecordingOptions& options) {
  BatchRecordingOptions reading;
  reading.rawlog = rawlog;
  reading.vehicle = options.vehicle;
  reading.map = options.map;
  reading.start = options.start;
  reading.pixels = options.images;
  reading.audit = options.audit;
  return readBatchRecording(reading, options.calibration.empty() ? EffectParameters<double>{}
                                                                 : readCalibration(options.calibration));
}

Diagnosis diagnose(const BatchRecording& recording, DiagnosisOptions options) {
  options.calibration = recording.calibration;
  return diagnose(recording.input, options);
}

LocalizedPath localize(const fs::path& rawlog, const LocalizationOptions& options,
                       const RecordingOptions& recording) {
  const bool landmarks =
      std::find(options.fuse.begin(), options.fuse.end(), kChannel<Landmark>) != options.fuse.end();
  const SampleChain chain({.rawlog = rawlog,
                           .vehicle = recording.vehicle,
                           .map = recording.map,
                           .calibration = recording.calibration,
                           .audit = recording.audit},
                          landmarks);
  LocalizationSetup setup = chain.setup();
  setup.options = options;
  setup.start = startPose(recording.start, rawlog, {});

  LocalizedPath path;
  path.remarks = chain.remarks();
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& estimate) { path.filtered.push_back(estimate); };
  sink.smoothed = [&](const Estimate& estimate) { path.smoothed.push_back(estimate); };
  sink.event = [&](const Event& event) { path.events.push_back(event); };
  const auto samples = chain.open();
  path.summary = localize(
      setup, [&] { return samples->next(); }, sink);
  path.loss = samples->loss();
  if (path.loss) path.remarks.push_back("The recording is damaged: " + describe(*path.loss));
  return path;
}

RecordingFiles simulate(const fs::path& trajectory, const fs::path& vehicle, const fs::path& folder,
                        const SimulatedDive& dive) {
  SimulationOptions options;
  options.vehicle = readVehicle(vehicle);
  options.effects = dive.effects;
  options.duration_s = dive.duration_s;
  options.seed = dive.seed;
  options.noise = dive.noise;
  const RecordingTarget target{.folder = folder,
                               .name = trajectory.stem().string(),
                               .vehicle_file = vehicle,
                               .panel_map = dive.panel_map.value_or(""),
                               .description = "simulated by fathom",
                               .environment = dive.environment};
  return simulateRecording(options, readTrajectory(trajectory), target);
}

}  // namespace fathom
