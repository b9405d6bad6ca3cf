#include <benchmark/benchmark.h>

#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"

// 10 h at 100 Hz are 3.6 million readings of the INS: what one costs, alone and on its way to the disk.
namespace fathom {
namespace {

namespace fs = std::filesystem;
const fs::path kConfig = fs::path(FATHOM_SOURCE_DIR) / "config";

void trajectoryAt(benchmark::State& state) {
  const Trajectory dive = readTrajectory(kConfig / "dive_trajectory.yaml");
  double t = 0;
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(dive.at(t));
    t += 0.01;
    if (t > dive.end_s()) t = 0;
  }
}
BENCHMARK(trajectoryAt);

void trajectoryOf360000Poses(benchmark::State& state) {  // 10 h at 10 Hz
  std::vector<double> times_s;
  std::vector<Pose> poses;
  for (int i = 0; i < 360'000; ++i) {
    times_s.push_back(0.1 * i);
    poses.push_back(
        {expSO3<double>(Vector3d(0.1 * std::sin(0.05 * i), 0, 0.01 * i)), Vector3d(0.01 * i, 0, -4)});
  }
  while (state.KeepRunning()) benchmark::DoNotOptimize(Trajectory(times_s, poses).end_s());
}
BENCHMARK(trajectoryOf360000Poses)->Unit(benchmark::kMillisecond);

SimulationOptions options() {
  SimulationOptions result;
  result.vehicle = readVehicle(kConfig / "rov.yaml");
  return result;
}

void simulateDiveToNowhere(benchmark::State& state) {
  const Trajectory dive = readTrajectory(kConfig / "dive_trajectory.yaml");
  std::int64_t samples = 0;
  while (state.KeepRunning()) simulateNavigation(options(), dive, [&](const Sample&) { ++samples; });
  state.SetItemsProcessed(samples);
}
BENCHMARK(simulateDiveToNowhere)->Unit(benchmark::kMillisecond);

void simulateDiveToDisk(benchmark::State& state) {
  const Trajectory dive = readTrajectory(kConfig / "dive_trajectory.yaml");
  const fs::path folder = fs::temp_directory_path() / "fathom-bench";
  while (state.KeepRunning())
    simulateRecording(options(), dive, {folder, "dive", kConfig / "rov.yaml", "", "", {}});
}
BENCHMARK(simulateDiveToDisk)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fathom

BENCHMARK_MAIN();
