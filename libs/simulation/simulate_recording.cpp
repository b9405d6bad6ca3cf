#include "simulation/simulate_recording.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "recording/rawlog.h"
#include "recording/tum.h"

namespace fathom {

RecordingFiles simulateRecording(const SimulationOptions& options, const Trajectory& trajectory,
                                 const RecordingTarget& target) {
  RecordingFiles files{target.folder / (target.name + ".rawlog"),
                       target.folder / (target.name + "_vehicle.yaml"),
                       target.folder / (target.name + "_truth.tum")};
  const double duration_s = simulatedDuration_s(options, trajectory);
  const std::string vehicle_text = readTextFile(target.vehicle_file);
  PendingFile truth(files.truth);
  std::ofstream truth_out(truth.path(), std::ios::binary);
  const RecordingHeader header{target.panel_map, files.vehicle.filename().string(), target.description};
  RawlogWriter rawlog(files.rawlog, header, options.start);

  Progress progress("simulating " + target.name);
  simulateNavigation(options, trajectory, [&](const Sample& sample) {
    rawlog.write(sample);
    if (sample.label != labels::kTruth) return;
    const auto& pose = std::get<PoseSample>(sample.reading).T_odom_robot.mean;
    writeTumLine(truth_out, {sample.time, Pose::fromMrpt(pose)});
    progress.update(secondsBetween(options.start, sample.time) / std::max(duration_s, 1e-9));
  });

  truth_out.close();
  if (!truth_out) throw Error(files.truth.string(), "", "cannot be written");
  writeTextFile(files.vehicle, vehicle_text);
  truth.commit();
  rawlog.finish();
  return files;
}

}  // namespace fathom
