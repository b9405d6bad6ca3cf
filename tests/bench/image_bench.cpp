// What an image costs after its rendering: through the water, and through the sensor.
#include <benchmark/benchmark.h>

#include "imaging/image_model.h"

namespace fathom {
namespace {

const Water kWater{{1.1, 0.68, 0.74}, {0.05, 0.24, 0.22}};

void light(benchmark::State& state) {
  const CameraSheet sheet;
  const ImageModel model(sheet, kWater);
  const cv::Mat radiance(480, 640, CV_32FC3, cv::Scalar(0.5, 0.4, 0.3)), range(480, 640, CV_32FC1, 2.5);
  for (auto _ : state) benchmark::DoNotOptimize(model.light(radiance, range).data);
}
BENCHMARK(light)->Unit(benchmark::kMillisecond);

void expose(benchmark::State& state) {
  const CameraSheet sheet;
  const ImageModel model(sheet, kWater);
  const cv::Mat radiance(480, 640, CV_32FC3, cv::Scalar(0.5, 0.4, 0.3));
  Random random(1);
  for (auto _ : state) benchmark::DoNotOptimize(model.expose(radiance, &random).data);
}
BENCHMARK(expose)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fathom

BENCHMARK_MAIN();
