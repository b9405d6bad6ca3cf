#include "simulation/image_simulator.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "core/for_each.h"
#include "core/version.h"
#include "effects/calibration.h"
#include "effects/drawn.h"
#include "image_files/bayer.h"
#include "imaging/fingerprints.h"
#include "render/scene.h"
#include "sensors/channel_model.h"
#include "simulation/image_store.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// Numbers of the images' random streams, beyond those of the navigation sensors: left image k, right image
/// k.
std::uint64_t noiseStream(std::size_t image, std::size_t side) { return (side + 1) << 32 | image; }

/// Each eye of a pair draws flakes of its own: no two of them show the same one.
std::uint64_t particleSeed(std::uint64_t seed, std::size_t side) { return seed ^ std::uint64_t{side} << 32; }

/// Everything that one image depends on besides its number.
struct Dive {
  const SimulationOptions& options;
  const Trajectory& trajectory;
  const CameraSheet& sheet;
  const CameraStudio& studio;
  std::optional<Vector3d> first_panel_odom;

  double stamp_s(std::size_t image) const { return secondsBetween(options.start, imageTime(options, image)); }

  KinematicState<double> motion(std::size_t image) const {
    const double t_s = stamp_s(image);
    const double valid_s = t_s + validityOffset<Camera>(options.effects, t_s);
    return trajectory.at(std::clamp(options.begin_s + valid_s, trajectory.start_s(), trajectory.end_s()));
  }

  cv::Mat image(std::size_t number, std::size_t side) const {
    const double t_s = stamp_s(number);
    const KinematicState<double> state = motion(number);
    const TrueCamera camera = trueCamera(sheet.model, sheet.T_robot_camera, state, options.effects, t_s,
                                         side == 0 ? Pose{} : *sheet.T_left_right, first_panel_odom);
    Random noise = Random::stream(options.seed, noiseStream(number, side));
    return studio.image({{state.R_odom_robot, state.position_odom},
                         camera,
                         t_s,
                         drawnFor(options.effects, options.seed, t_s),
                         particleSeed(options.seed, side)},
                        options.noise ? &noise : nullptr);
  }
};

std::string mountingFingerprint(const CameraSheet& sheet) {
  Fingerprint fingerprint;
  add(fingerprint, sheet.T_robot_camera);
  if (sheet.T_left_right) add(fingerprint, *sheet.T_left_right);
  return fingerprint.hex();
}

std::string posesFingerprint(const Dive& dive, std::size_t count) {
  Fingerprint fingerprint;
  for (std::size_t i = 0; i < count; ++i) {
    const auto state = dive.motion(i);
    add(fingerprint, {state.R_odom_robot, state.position_odom});
  }
  return fingerprint.hex();
}

std::string formatText(const ImageFormat& format) {
  if (format.kind == ImageFormat::Kind::png) return "";
  return "JPEG of quality " + std::to_string(format.jpeg_quality) + "\n";
}

std::string inputsOf(const Dive& dive, const CameraWorld& world, std::size_t count) {
  const SimulationOptions& options = dive.options;
  return "What these images were simulated from; a run with other inputs removes them.\n"
         "version " +
         std::string(programVersion()) + "\ncamera " + fingerprintOf(dive.sheet) + "\nmounting " +
         mountingFingerprint(dive.sheet) + "\nlamps " + fingerprintOf(options.vehicle.lamps) +
         "\nwater and light " + fingerprintOf(world.environment) + "\nscene " +
         fingerprintOf(sceneOf(world.panels, world.sea_floor_odom)) + "\nposes " +
         posesFingerprint(dive, count) + "\n" + (options.noise ? "noise" : "no noise, draws") + " of seed " +
         std::to_string(options.seed) + "\n" + formatText(options.image_format) +
         formatCalibration(options.effects);
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
  const CameraStudio studio(world, sheet, options.vehicle.lamps, options.effects);
  Dive dive{options, trajectory, sheet, studio, {}};
  if (!world.panels.empty()) dive.first_panel_odom = world.panels.front().T_odom_panel.position;
  const std::size_t count = imageCount(options, trajectory);
  const ImageStore store(folder, inputsOf(dive, world, count), options.image_format);
  const auto make = [&](std::size_t number) {
    const auto files = imageFiles(sheet, options.image_format, number);
    for (std::size_t side = 0; side < files.size(); ++side)
      if (!store.has(files[side]))
        store.write(files[side], mosaic(dive.image(number, side), sheet.model.bayer));
  };
  forEachIndex(count, "rendering " + std::to_string(count) + " images", make,
               imagesAtOnce(sheet.model.width_px, sheet.model.height_px));
}

}  // namespace fathom
