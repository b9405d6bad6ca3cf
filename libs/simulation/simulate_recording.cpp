#include "simulation/simulate_recording.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "recording/tum.h"
#include "render/scene.h"
#include "simulation/copy_panel_map.h"
#include "simulation/image_simulator.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kSandStream = std::uint64_t{1} << 63;  // far from the sensors' and images' streams
constexpr const char* kPanelFolder = "_panel";

void makeImages(const SimulationOptions& options, const Trajectory& trajectory, const RecordingTarget& target,
                const RecordingFiles& files) {
  std::error_code absent;
  fs::remove(files.rawlog, absent);  // it would tell of other images
  const auto panels = readPanelMaps(target.panel_map);
  const CameraWorld world{panels, seaFloorBelow(panels, options.sea_floor_z_m, sandOf(options.seed)),
                          *target.environment};
  options.vehicle.forEachInstance([&](const Instance& instance, const SensorsOnBoard& sensors) {
    if (!sensors.camera) return;
    SimulationOptions own = options;
    own.vehicle.camera = sensors.camera;
    own.effects = options.effects.of(instance);
    own.seed += instance.number();  // noise of its own
    simulateImages(own, trajectory, world, files.images / instance.name());
  });
}

void makeRawlog(const SimulationOptions& options, const Trajectory& trajectory, const RecordingTarget& target,
                const RecordingFiles& files, PendingFile& truth) {
  const double duration_s = simulatedDuration_s(options, trajectory);
  const std::string vehicle_text = readTextFile(target.vehicle_file);
  std::ofstream truth_out(truth.path(), std::ios::binary);
  const auto named = [&](const fs::path& file) {
    return file.lexically_relative(target.folder).generic_string();
  };
  const RecordingHeader header{files.panel_map.empty() ? "" : named(files.panel_map), named(files.vehicle),
                               target.description};
  RawlogWriter rawlog(files.rawlog, header, options.start);

  Progress progress("simulating " + target.name);
  simulateNavigation(options, trajectory, [&](const Sample& sample) {
    rawlog.write(sample);
    if (sample.label != labels::kTruth) return;
    const auto& pose = std::get<PoseSample>(sample.reading).T_odom_robot.mean;
    writeTumLine(truth_out, {sample.time, pose});
    progress.update(secondsBetween(options.start, sample.time) / std::max(duration_s, 1e-9));
  });

  truth_out.close();
  if (!truth_out) throw Error(files.truth.string(), "", "cannot be written");
  writeTextFile(files.vehicle, vehicle_text);
  if (!files.panel_map.empty()) copyPanelMap(target.panel_map, target.folder / (target.name + kPanelFolder));
  truth.commit();
  rawlog.finish();
}

}  // namespace

Random sandOf(std::uint64_t seed) { return Random::stream(seed, kSandStream); }

RecordingFiles simulateRecording(const SimulationOptions& options, const Trajectory& trajectory,
                                 const RecordingTarget& target) {
  const auto named = [&](const std::string& ending) { return target.folder / (target.name + ending); };
  RecordingFiles files{named(".rawlog"), named("_vehicle.yaml"), named("_truth.tum"), {}, {}, 0};
  if (!target.panel_map.empty()) files.panel_map = copyOfPanelMap(target.panel_map, named(kPanelFolder));
  PendingFile truth(files.truth);  // from here on, so that no other run makes this recording's images too
  SimulationOptions with_images = options;
  with_images.images = hasCamera(options.vehicle) && target.environment && !target.panel_map.empty();
  if (with_images.images) {
    files.images = named("_Images");
    files.image_entries = imageCount(options, trajectory);
    makeImages(options, trajectory, target, files);
  }
  makeRawlog(with_images, trajectory, target, files, truth);
  return files;
}

}  // namespace fathom
