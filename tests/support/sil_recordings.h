#pragma once

#include <map>

#include "core/files.h"
#include "observables/known_world.h"
#include "observables/posed_images.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "support/shared_data.h"
#include "support/shipped.h"

/// Small simulated recordings for the simulation in the loop: 320 x 240 px, one image a second, two metres
/// before the shipped panel.
namespace fathom::test {

inline const std::filesystem::path kSilWater = kConfig / "water_moderate.yaml";

struct SilRecordingOptions {
  int images = 3;
  bool noise = true;
  double yaw_deg = 1;  ///< 180: the panel is behind
  bool stereo = false;
  EffectParameters<double> effects{};
  double exposure_s = 0.004;  ///< the vehicle file's
};

/// Of the shipped vehicle with a camera of half the size, and without its INS, which has nothing to say here.
inline SimulationOptions smallCameraOptions() {
  SimulationOptions options;
  options.vehicle = readVehicle(kRov);
  options.vehicle.ins.reset();
  CameraModel& model = options.vehicle.camera->model;
  model.width_px /= 2;
  model.height_px /= 2;
  for (double* value : {&model.fx_px, &model.fy_px, &model.cx_px, &model.cy_px}) *value /= 2;
  return options;
}

/// The recording `r` in the folder: a dive along a trajectory (the text of its file) before the shipped
/// panel.
inline RecordingFiles simulateBeforePanel(const std::filesystem::path& folder, const std::string& trajectory,
                                          const std::filesystem::path& water,
                                          const SimulationOptions& options) {
  writeTextFile(folder / "trajectory.yaml", trajectory);
  return simulateRecording(options, readTrajectory(folder / "trajectory.yaml"),
                           {folder, "r", kRov, kDexrovMap, "a test", readEnvironment(water)});
}

/// A station 2 m before the panel: the text of its file, and the path that it is.
inline std::string silTrajectory(double yaw_deg = 1) {
  return "kind: station\npose: {x: 3.9, y: 0.05, z: -4.25, yaw_deg: " + std::to_string(yaw_deg) +
         "}\nduration_s: 20\nsway:\n  - {axis: y, amplitude_m: 0.1, period_s: 7}\n"
         "  - {axis: roll, amplitude_deg: 4, period_s: 5}\n";
}
inline constexpr double kSilBegin_s = 5;  ///< on that path, of the recording
inline Trajectory silPath() {
  const std::filesystem::path file = scratchFolder() / "path.yaml";
  writeTextFile(file, silTrajectory());
  return readTrajectory(file);
}

inline RecordingFiles simulateForSil(const std::filesystem::path& folder,
                                     const SilRecordingOptions& wanted = {}) {
  SimulationOptions options = smallCameraOptions();
  options.begin_s = kSilBegin_s;
  options.duration_s = wanted.images - 0.5;
  options.noise = wanted.noise;
  options.effects = wanted.effects;
  options.vehicle.camera->exposure_s = wanted.exposure_s;
  if (wanted.stereo) options.vehicle.camera->T_left_right = Pose{Matrix3d::Identity(), {0.1, 0, 0}};
  return simulateBeforePanel(folder, silTrajectory(wanted.yaw_deg), kSilWater, options);
}

/// What the simulator above knew. Its vehicle's camera differs from the vehicle file's in size only.
inline KnownWorld silWorld() {
  return {
      readVehicle(kRov), readPanelMaps(kDexrovMap), readEnvironment(kSilWater), {}, KnownSeaFloor{-6.0, 1}};
}

inline DetectionSettings silDetection() { return settingsFor(readPanelMaps(kDexrovMap)); }

/// With each image's pose and motion, of a recording by simulateForSil(), replaced by the truth.
inline PosedImages atTruth(PosedImages images, const std::filesystem::path& rawlog) {
  std::map<Time, Pose> truth;
  std::optional<Time> time_zero;
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next()) {
    if (!time_zero) time_zero = sample->time;
    if (sample->label == labels::kTruth)
      truth[sample->time] = std::get<PoseSample>(sample->reading).T_odom_robot.mean;
  }
  const Trajectory path = readTrajectory(rawlog.parent_path() / "trajectory.yaml");
  for (PosedImage& posed : images.posed) {
    posed.T_odom_robot.pose = truth.at(posed.time);
    posed.camera.projector = movingWith(
        path.at(kSilBegin_s + secondsBetween(*time_zero, posed.time)),
        cameraMounting(posed.T_robot_camera, EffectParameters<double>{}, posed.t_s), posed.camera.projector);
  }
  return images;
}

}  // namespace fathom::test
