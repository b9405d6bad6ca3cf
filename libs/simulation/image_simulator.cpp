#include "simulation/image_simulator.h"

#include <tbb/enumerable_thread_specific.h>

#include <stdexcept>

#include "core/fingerprint.h"
#include "core/for_each.h"
#include "effects/calibration.h"
#include "render/renderer.h"
#include "sensors/image_model.h"
#include "simulation/image_store.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// Numbers of the images' random streams, beyond those of the navigation sensors: left image k, right image
/// k.
std::uint64_t noiseStream(std::size_t image, std::size_t eye) { return (eye + 1) << 32 | image; }

/// Everything that one image depends on besides its number.
struct Studio {
  const SimulationOptions& options;
  const Trajectory& trajectory;
  const CameraWorld& world;
  const CameraSheet& sheet;
  ImageModel model;

  Pose T_odom_robot(std::size_t image) const {
    const double seconds = secondsBetween(options.start, imageTime(options, image));
    const auto state = trajectory.at(options.begin_s + seconds);
    return {state.R_odom_robot, state.position_odom};
  }

  Lighting lighting(const Pose& T_odom_robot) const {
    Lighting light{world.environment.ambient.cast<float>(), {}};
    if (const auto& irradiance = world.environment.lamps_irradiance_1m)
      for (const LampSheet& lamp : options.vehicle.lamps)
        light.spots.push_back(
            {T_odom_robot * lamp.T_robot_lamp, lamp.half_angle_rad, irradiance->cast<float>()});
    return light;
  }

  cv::Mat image(std::size_t number, std::size_t eye, Renderer& renderer) const {
    const Pose robot = T_odom_robot(number);
    const Pose T_left_eye = eye == 0 ? Pose{} : *sheet.T_left_right;
    const View view = renderer.render(robot * sheet.T_robot_camera * T_left_eye, lighting(robot));
    Random noise = Random::stream(options.seed, noiseStream(number, eye));
    return model.expose(model.light(view.radiance, view.range_m), options.noise ? &noise : nullptr);
  }
};

void add(Fingerprint& fingerprint, const Pose& pose) {
  fingerprint.add(pose.rotation.data(), sizeof(double) * 9).add(pose.position.data(), sizeof(double) * 3);
}

std::string cameraFingerprint(const Vehicle& vehicle) {
  const CameraSheet& sheet = *vehicle.camera;
  const CameraModel& m = sheet.model;
  Fingerprint fingerprint;
  for (const double number :
       {1.0 * m.width_px, 1.0 * m.height_px, m.fx_px, m.fy_px, m.cx_px, m.cy_px, m.k1, m.k2, m.p1, m.p2, m.k3,
        sheet.exposure_s, sheet.response_gamma, 1.0 * sheet.bits, sheet.full_well_e, sheet.read_noise_e})
    fingerprint.add(number);
  add(fingerprint, sheet.T_robot_camera);
  if (sheet.T_left_right) add(fingerprint, *sheet.T_left_right);
  for (const LampSheet& lamp : vehicle.lamps) {
    fingerprint.add(lamp.half_angle_rad);
    add(fingerprint, lamp.T_robot_lamp);
  }
  return fingerprint.hex();
}

std::string environmentFingerprint(const Environment& environment) {
  Fingerprint fingerprint;
  for (const Vector3d& colour :
       {environment.water.attenuation_per_m, environment.water.veil, environment.ambient,
        environment.lamps_irradiance_1m.value_or(Vector3d(-1, -1, -1))})
    fingerprint.add(colour.data(), sizeof(double) * 3);
  return fingerprint.hex();
}

std::string sceneFingerprint(const Surface& scene) {
  Fingerprint fingerprint;
  for (const Surface::Vertex& vertex : scene.vertices)
    for (const Eigen::Vector3f& vector : {vertex.position, vertex.normal, vertex.albedo})
      fingerprint.add(vector.data(), sizeof(float) * 3);
  for (const auto& triangle : scene.triangles) fingerprint.add(triangle.data(), sizeof triangle);
  return fingerprint.hex();
}

std::string posesFingerprint(const Studio& studio, std::size_t count) {
  Fingerprint fingerprint;
  for (std::size_t i = 0; i < count; ++i) add(fingerprint, studio.T_odom_robot(i));
  return fingerprint.hex();
}

std::string formatText(const ImageFormat& format) {
  if (format.kind == ImageFormat::Kind::png) return "";
  return "JPEG of quality " + std::to_string(format.jpeg_quality) + "\n";
}

std::string inputsOf(const Studio& studio, std::size_t count) {
  const SimulationOptions& options = studio.options;
  return "What these images were simulated from; a run with other inputs removes them.\n"
         "version " FATHOM_VERSION "\ncamera and lamps " +
         cameraFingerprint(options.vehicle) + "\nwater and light " +
         environmentFingerprint(studio.world.environment) + "\nscene " +
         sceneFingerprint(studio.world.scene_odom) + "\nposes " + posesFingerprint(studio, count) + "\n" +
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
  const Studio studio{options, trajectory, world, sheet,
                      ImageModel(sheet, world.environment.water, options.effects)};
  const std::size_t count = imageCount(options, trajectory);
  const ImageStore store(folder, inputsOf(studio, count), options.image_format);

  tbb::enumerable_thread_specific<Renderer> renderers([&] {
    Renderer renderer(sheet.model);
    renderer.setScene(world.scene_odom);
    return renderer;
  });
  const auto make = [&](std::size_t number) {
    const auto files = imageFiles(sheet, options.image_format, number);
    for (std::size_t eye = 0; eye < files.size(); ++eye)
      if (!store.has(files[eye])) store.write(files[eye], studio.image(number, eye, renderers.local()));
  };
  forEachIndex(count, "rendering " + std::to_string(count) + " images", make);
}

}  // namespace fathom
