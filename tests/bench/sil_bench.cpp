// Pairs a second of the simulation in the loop (640 x 480, all measures, detections kept before), beside
// views a second of the renderer and the camera model alone from the same poses in the same run. Argument:
// the recording (default: the shipped trial), of which 100 images are taken. At least 10 pairs a second are
// asked for on two cores.
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "imaging/image_model.h"
#include "panel/panel_maps.h"
#include "render/scene.h"
#include "sil/sil_run.h"
#include "simulation/simulate_recording.h"
#include "support/stopwatch.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t kImages = 100;

/// Views a second, each through the water and the sensor.
double rendered(const PosedImages& images, const KnownWorld& world) {
  CameraSheet sheet = *world.vehicle.camera;
  sheet.model = images.posed.front().image.camera;
  const ImageModel model(sheet, world.environment.water);
  const Lighting light{world.environment.ambient.cast<float>(), {}};
  const Surface scene = sceneOf(world.panels, world.sea_floor->z_m, sandOf(world.sea_floor->sand_seed));
  tbb::enumerable_thread_specific<Renderer> renderers([&] {
    Renderer renderer(sheet.model);
    renderer.setScene(scene);
    return renderer;
  });
  const auto render = [&](std::size_t i) {
    const View view = renderers.local().render(images.posed[i].T_odom_camera(), light);
    Random noise(i);
    model.expose(model.light(view.radiance, view.range_m), &noise);
  };
  tbb::parallel_for(std::size_t{0}, std::size_t{8}, render);  // makes the renderers
  const auto start = std::chrono::steady_clock::now();
  tbb::parallel_for(std::size_t{0}, images.posed.size(), render);
  return static_cast<double>(images.posed.size()) / test::secondsSince(start);
}

/// Of all threads of this process.
double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double paired(const PosedImages& images, const PairMaker& maker, const SilOptions& options,
              const fs::path& out) {
  fs::remove_all(out);
  const auto start = std::chrono::steady_clock::now();
  const auto results = runSil(images, maker, options, {"bench", out, "bench", {}});
  return static_cast<double>(results.pairs.size()) / test::secondsSince(start);
}

int bench(const fs::path& rawlog) {
  const fs::path root = FATHOM_SOURCE_DIR;
  KnownWorld world{readVehicle(root / "config/trial_rov.yaml"),
                   readPanelMaps(root / "maps/dexrov/panel.yaml"),
                   readEnvironment(root / "config/water_turbid.yaml"),
                   {},
                   KnownSeaFloor{-6, 3}};
  SilOptions options;
  options.detection = settingsFor(world.panels, Backend::apriltag);
  PosedImages images = posedImages(rawlog, world.vehicle, world.panels, options.detection);
  if (images.posed.size() > kImages) images.posed.resize(kImages);
  const PairMaker maker(world, options.pairs, options.detection);

  const double views_s = rendered(images, world);
  const fs::path out = fs::temp_directory_path() / "fathom-sil-bench";
  const double processor_before_s = processor_s();
  const double pairs_s = paired(images, maker, options, out);
  const double processor_ms =
      1e3 * (processor_s() - processor_before_s) / static_cast<double>(images.posed.size());
  const double again_s = static_cast<double>(images.posed.size()) / [&] {
    const auto start = std::chrono::steady_clock::now();
    runSil(images, maker, options, {"bench", out, "bench", {}});
    return test::secondsSince(start);
  }();
  options.measures = {"rmse-linear"};
  options.video = false;
  const double bare_s = paired(images, maker, options, out);
  fs::remove_all(out);
  std::printf("%zu images of %d x %d\n", images.posed.size(), images.posed.front().image.camera.width_px,
              images.posed.front().image.camera.height_px);
  std::printf("rendered alone               %6.1f views/s\n", views_s);
  std::printf("paired, all measures, video  %6.1f pairs/s, ratio %.2f (asked: 10 pairs/s)\n", pairs_s,
              pairs_s / views_s);
  std::printf("  processor time %.0f ms a pair: %.1f pairs/s on two cores that do nothing else\n",
              processor_ms, 2e3 / processor_ms);
  std::printf("the same, taken over         %6.1f pairs/s, ratio %.2f\n", again_s, again_s / views_s);
  std::printf("paired, one measure          %6.1f pairs/s, ratio %.2f\n", bare_s, bare_s / views_s);
  return 0;
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) {
  return fathom::bench(argc > 1 ? std::filesystem::path(argv[1])
                                : std::filesystem::path(FATHOM_SOURCE_DIR) / "rawlogs/trial/trial.rawlog");
}
