// Views a second of a panel of 5000 triangles on the sea floor, 640 x 480, each sent through the water: one
// Renderer, a Renderer a core, and what the edges' supersampling costs. `ratio` is views a second over those
// of one Renderer without supersampling, seen in the same run.
#include <benchmark/benchmark.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <chrono>

#include "imaging/image_model.h"
#include "support/render_scenes.h"
#include "support/stopwatch.h"

namespace fathom::test {
namespace {

constexpr int kViews = 32;

Pose poseOf(int view) {
  return lookingAt(kPanelPosition_odom + Vector3d(-1.6, -0.5 + 0.03 * view, 0.2), kPanelPosition_odom);
}

const ImageModel& water() {
  static const ImageModel model = [] {
    CameraSheet sheet;
    sheet.model = rovCamera();
    return ImageModel(sheet, Water{.attenuation_per_m = {0.6, 0.15, 0.1}, .veil = {0.02, 0.1, 0.12}});
  }();
  return model;
}

Renderer makeRenderer(int supersampling) {
  Renderer renderer(rovCamera(), Renderer::Options{supersampling});
  renderer.setScene(panelOnSeaFloor());
  return renderer;
}

void renderView(Renderer& renderer, View& image, int view, bool lamps, bool in_water) {
  const Pose pose = poseOf(view % kViews);
  const Lighting lighting = lamps ? lampsBeside(pose, 0.2f, 1.0f) : Lighting{};
  renderer.render(pose, lighting, image);
  if (in_water) benchmark::DoNotOptimize(water().light(image.radiance, image.range_m).data);
}

/// Counts views a second, and their ratio to those of the reference (0 where it was filtered out).
void report(benchmark::State& state, int views, double seconds) {
  static double reference = 0;
  const double rate = views / seconds;
  if (state.range(0) == 1) reference = rate;
  state.counters["views/s"] = rate;
  state.counters["ratio"] = reference > 0 ? rate / reference : 0;
}

/// Arguments: supersampling, lamps, water.
void oneRenderer(benchmark::State& state) {
  Renderer renderer = makeRenderer(static_cast<int>(state.range(0)));
  View image;
  renderView(renderer, image, 0, true, true);
  int view = 0;
  const auto start = std::chrono::steady_clock::now();
  while (state.KeepRunning()) renderView(renderer, image, view++, state.range(1) != 0, state.range(2) != 0);
  report(state, view, test::secondsSince(start));
}
BENCHMARK(oneRenderer)
    ->ArgNames({"supersampling", "lamps", "water"})
    ->Args({1, 1, 1})
    ->Args({5, 1, 1})
    ->Args({8, 1, 1})
    ->Args({5, 0, 0})
    ->Args({5, 1, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void aRendererACore(benchmark::State& state) {
  tbb::enumerable_thread_specific<Renderer> renderers(
      [&] { return makeRenderer(static_cast<int>(state.range(0))); });
  tbb::enumerable_thread_specific<View> images;
  const auto renderAll = [&] {
    tbb::parallel_for(0, kViews, [&](int view) {
      renderView(renderers.local(), images.local(), view, state.range(1) != 0, state.range(2) != 0);
    });
  };
  renderAll();
  int views = 0;
  const auto start = std::chrono::steady_clock::now();
  while (state.KeepRunning()) {
    renderAll();
    views += kViews;
  }
  report(state, views, test::secondsSince(start));
}
BENCHMARK(aRendererACore)
    ->ArgNames({"supersampling", "lamps", "water"})
    ->Args({5, 1, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace fathom::test

BENCHMARK_MAIN();
