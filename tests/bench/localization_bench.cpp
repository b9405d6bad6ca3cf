#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "bench/child.h"
#include "localization/localizer.h"
#include "recording/rawlog.h"
#include "simulation/simulate_recording.h"

// Time and peak memory of localizing recordings of 1 min to 10 h (config/rov.yaml: INS 100 Hz, DVL with beams
// and pressure 5 Hz; 23 states, reading included), each in a child process of its own. The ratio is that of
// the time a minute of recording takes to what it takes in the shortest one.
//   localization_bench [longest, minutes]
namespace {

using namespace fathom;
using namespace fathom::test;
namespace fs = std::filesystem;

struct Figures {
  double simulate_s = 0, localize_s = 0, peak_mb = 0, file_mb = 0;
  std::size_t samples = 0, estimates = 0;
};

const fs::path kConfig = fs::path(FATHOM_SOURCE_DIR) / "config";

/// Round and round a circle of 10 m, half a metre a second.
Trajectory circles(int minutes) {
  std::vector<double> times_s;
  std::vector<Pose> poses;
  for (double t = -5.0; t <= 60.0 * minutes + 5.0; t += 1.0) {
    const double angle = 0.05 * t;
    times_s.push_back(t);
    poses.push_back(
        {rotationFromYawPitchRoll(angle, 0, 0), {10 * std::sin(angle), -10 * std::cos(angle), -3}});
  }
  return {times_s, poses};
}

void simulate(const fs::path& folder, int minutes, Figures& figures) {
  const auto begin = std::chrono::steady_clock::now();
  SimulationOptions options;
  options.vehicle = readVehicle(kConfig / "rov.yaml");
  options.duration_s = 60.0 * minutes;
  const auto files = simulateRecording(options, circles(minutes),
                                       {folder, "bench", kConfig / "rov.yaml", "", "bench", std::nullopt});
  figures.simulate_s = secondsSince(begin);
  figures.file_mb = static_cast<double>(fs::file_size(files.rawlog)) / 1e6;
}

void localizeIt(const fs::path& folder, Figures& figures) {
  const auto begin = std::chrono::steady_clock::now();
  RawlogReader reader(folder / "bench.rawlog");
  LocalizationSetup setup;
  setup.vehicle = readVehicle(kConfig / "rov.yaml");
  setup.options = readLocalizationOptions(kConfig / "navigation.yaml");
  setup.options.smooth = false;  // it keeps 3.6 kB a step
  auto first = reader.next();
  setup.time_zero = first->time;
  LocalizationSink sink;
  sink.estimate = [&](const Estimate&) { ++figures.estimates; };
  const auto summary = localize(
      setup, [&] { return first ? std::exchange(first, std::nullopt) : reader.next(); }, sink);
  if (!summary.started || reader.loss()) std::abort();
  figures.samples = summary.samples;
  figures.localize_s = secondsSince(begin);
  figures.peak_mb = peakMegabytes();
}

}  // namespace

int main(int argc, char** argv) {
  const int longest_min = argc > 1 ? std::atoi(argv[1]) : 600;
  const fs::path folder = fs::temp_directory_path() / ("localization_bench." + std::to_string(getpid()));
  fs::create_directories(folder);
  std::printf("%8s %9s %9s %10s | %10s %10s %8s %7s %6s\n", "minutes", "samples", "file MB", "simulate s",
              "localize s", "estimates", "peak MB", "ms/min", "ratio");
  int status = 0;
  double first_ms_per_min = 0;
  for (const int minutes : {1, 10, 100, 600}) {
    if (minutes > longest_min) break;
    Figures f;
    const bool done = inChild(f, [&](Figures& out) { simulate(folder, minutes, out); }) &&
                      inChild(f, [&](Figures& out) { localizeIt(folder, out); });
    if (!done) {
      std::fprintf(stderr, "localization_bench: %d minutes failed\n", minutes);
      status = 1;
      break;
    }
    const double ms_per_min = 1e3 * f.localize_s / minutes;
    if (first_ms_per_min == 0) first_ms_per_min = ms_per_min;
    std::printf("%8d %9zu %9.1f %10.2f | %10.2f %10zu %8.1f %7.1f %6.2f\n", minutes, f.samples, f.file_mb,
                f.simulate_s, f.localize_s, f.estimates, f.peak_mb, ms_per_min,
                ms_per_min / first_ms_per_min);
    std::fflush(stdout);
  }
  fs::remove_all(folder);
  return status;
}
