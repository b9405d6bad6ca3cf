// Time of fitting water to 50 pairs of 640 x 480 px, beside that of rendering them.
//
//     build/release/tests/fit_water_bench
#include <cstdio>

#include "environment/water_study.h"
#include "support/sil_recordings.h"
#include "support/stopwatch.h"

namespace {

using namespace fathom;
using test::seconds;

}  // namespace

int main() {
  const auto folder = std::filesystem::temp_directory_path() / "fathom-fit-water-bench";
  SimulationOptions options;
  options.vehicle = readVehicle(test::kConfig / "trial_rov.yaml");
  options.duration_s = 45;
  const RecordingFiles recording =
      simulateRecording(options, readTrajectory(test::kConfig / "trial_trajectory.yaml"),
                        {folder, "bench", test::kConfig / "trial_rov.yaml", test::kDexrovMap, "a bench",
                         readEnvironment(test::kSilWater)});
  const PosedImages images =
      posedImages(recording.rawlog, readPanelMaps(test::kDexrovMap), test::silDetection());
  SilWorld world = test::silWorld();
  world.vehicle = options.vehicle;
  const PairMaker maker(world, {}, test::silDetection());
  std::vector<std::size_t> some;
  // The nearest, with the most patches.
  for (std::size_t i = images.posed.size() - 50; i < images.posed.size(); ++i) some.push_back(i);
  maker.clean(images.posed.front());  // tools are made once

  SynchronizedImages pairs;
  WaterFit fit;
  const double rendering_s = seconds([&] {
    for (const std::size_t i : some) maker.clean(images.posed[i]);
  });
  const double patches_s = seconds([&] { pairs = synchronize(images.posed, some, maker); });
  const double fit_s = seconds([&] { fit = fitWater(pairs.patches, pairs.images.size()); });
  std::printf(
      "%zu pairs, %zu patches\nrendering alone, one core: %.2f s\nrendering and patches, all cores: "
      "%.2f s\nfit: %.2f s\ntogether: %.2f s (asked: 20), %.1f times the rendering\n",
      pairs.images.size(), pairs.patches.size(), rendering_s, patches_s, fit_s, patches_s + fit_s,
      (patches_s + fit_s) / rendering_s);
  return fit.solved ? 0 : 1;
}
