#include "simulation/image_simulator.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "core/for_each.h"
#include "effects/calibration.h"
#include "render/renderer.h"
#include "render/scene.h"
#include "sensors/camera_geometry.h"
#include "sensors/fingerprints.h"
#include "sensors/image_model.h"
#include "sensors/true_panel.h"
#include "simulation/apparent_scene.h"
#include "simulation/image_store.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// Numbers of the images' random streams, beyond those of the navigation sensors: left image k, right image
/// k.
std::uint64_t noiseStream(std::size_t image, std::size_t side) { return (side + 1) << 32 | image; }

/// A thread's renderer and sensor of the camera of the latest image.
struct Eye {
  CameraModel camera;
  Renderer renderer;
  ImageModel model;
};

/// Everything that one image depends on besides its number.
struct Studio {
  const SimulationOptions& options;
  const Trajectory& trajectory;
  const CameraWorld& world;
  const CameraSheet& sheet;
  Surface nominal_scene = sceneOf(world.panels, world.sea_floor_odom);
  bool bent = anyActsAt<FlatPort<double>>(options.effects) || anyActsAt<Shutter<double>>(options.effects);

  double stamp_s(std::size_t image) const { return secondsBetween(options.start, imageTime(options, image)); }

  KinematicState<double> motion(std::size_t image) const {
    const double t_s = stamp_s(image);
    const double valid_s = t_s + validityOffset<Sensor::camera>(options.effects, t_s);
    return trajectory.at(std::clamp(options.begin_s + valid_s, trajectory.start_s(), trajectory.end_s()));
  }

  Lighting lighting(const Pose& T_odom_robot) const {
    Lighting light{world.environment.ambient.cast<float>(), {}};
    if (const auto& irradiance = world.environment.lamps_irradiance_1m)
      for (const LampSheet& lamp : options.vehicle.lamps)
        light.spots.push_back(
            {T_odom_robot * lamp.T_robot_lamp, lamp.half_angle_rad, irradiance->cast<float>()});
    return light;
  }

  Surface scene(double t_s, const Pose& T_odom_camera, const CameraProjector<double>& projector) const {
    std::vector<PanelMap> panels;
    for (const PanelMap& panel : world.panels) panels.push_back(truePanel(panel, options.effects, t_s));
    Surface there = sceneOf(panels, world.sea_floor_odom);
    return bent ? apparentScene(there, T_odom_camera, projector) : there;
  }

  /// The lens can change in time; mostly it is that of the image before.
  Eye& prepared(std::optional<Eye>& eye, const CameraModel& camera) const {
    if (eye && eye->camera == camera) return *eye;
    CameraSheet true_sheet = sheet;
    true_sheet.model = camera;
    eye.emplace(
        Eye{camera, Renderer(camera), ImageModel(true_sheet, world.environment.water, options.effects)});
    eye->renderer.setScene(nominal_scene);
    return *eye;
  }

  cv::Mat image(std::size_t number, std::size_t side, std::optional<Eye>& thread_eye) const {
    const double t_s = stamp_s(number);
    const KinematicState<double> state = motion(number);
    const Pose T_odom_robot{state.R_odom_robot, state.position_odom};
    const auto mount =
        cameraMounting(sheet.T_robot_camera, options.effects, t_s, side == 0 ? Pose{} : *sheet.T_left_right);
    const Pose T_odom_camera = T_odom_robot * Pose{mount.R_robot_sensor, mount.position_robot};
    const auto projector = movingWith(state, mount, cameraProjector(sheet.model, options.effects, t_s));

    Eye& eye = prepared(thread_eye, projector.lensModel(sheet.model));
    if (bent || movesPanels(options.effects)) eye.renderer.setScene(scene(t_s, T_odom_camera, projector));
    const View view = eye.renderer.render(T_odom_camera, lighting(T_odom_robot));
    Random noise = Random::stream(options.seed, noiseStream(number, side));
    return eye.model.expose(eye.model.light(view.radiance, view.range_m, t_s),
                            options.noise ? &noise : nullptr, t_s);
  }
};

std::string mountingFingerprint(const CameraSheet& sheet) {
  Fingerprint fingerprint;
  add(fingerprint, sheet.T_robot_camera);
  if (sheet.T_left_right) add(fingerprint, *sheet.T_left_right);
  return fingerprint.hex();
}

std::string posesFingerprint(const Studio& studio, std::size_t count) {
  Fingerprint fingerprint;
  for (std::size_t i = 0; i < count; ++i) {
    const auto state = studio.motion(i);
    add(fingerprint, {state.R_odom_robot, state.position_odom});
  }
  return fingerprint.hex();
}

std::string formatText(const ImageFormat& format) {
  if (format.kind == ImageFormat::Kind::png) return "";
  return "JPEG of quality " + std::to_string(format.jpeg_quality) + "\n";
}

std::string inputsOf(const Studio& studio, std::size_t count) {
  const SimulationOptions& options = studio.options;
  return "What these images were simulated from; a run with other inputs removes them.\n"
         "version " FATHOM_VERSION "\ncamera " +
         fingerprintOf(studio.sheet) + "\nmounting " + mountingFingerprint(studio.sheet) + "\nlamps " +
         fingerprintOf(options.vehicle.lamps) + "\nwater and light " +
         fingerprintOf(studio.world.environment) + "\nscene " + fingerprintOf(studio.nominal_scene) +
         "\nposes " + posesFingerprint(studio, count) + "\n" +
         (options.noise ? "noise of seed " + std::to_string(options.seed) : "no noise") + "\n" +
         formatText(options.image_format) + formatCalibration(options.effects);
}

}  // namespace

std::size_t imageCount(const SimulationOptions& options, const Trajectory& trajectory) {
  if (!options.vehicle.camera) return 0;
  const Time end = after(options.start, simulatedDuration_s(options, trajectory));
  std::size_t count = 0;
  while (imageTime(options, count) <= end) ++count;
  return count;
}

void simulateImages(const SimulationOptions& options, const Trajectory& trajectory, const CameraWorld& world,
                    const fs::path& folder) {
  if (!options.vehicle.camera) throw std::invalid_argument("simulateImages needs a camera");
  const CameraSheet& sheet = *options.vehicle.camera;
  const Studio studio{options, trajectory, world, sheet};
  const std::size_t count = imageCount(options, trajectory);
  const ImageStore store(folder, inputsOf(studio, count), options.image_format);

  tbb::enumerable_thread_specific<std::optional<Eye>> eyes;
  const auto make = [&](std::size_t number) {
    const auto files = imageFiles(sheet, options.image_format, number);
    for (std::size_t side = 0; side < files.size(); ++side)
      if (!store.has(files[side])) store.write(files[side], studio.image(number, side, eyes.local()));
  };
  forEachIndex(count, "rendering " + std::to_string(count) + " images", make);
}

}  // namespace fathom
