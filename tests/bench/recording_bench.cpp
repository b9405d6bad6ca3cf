#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "bench/child.h"
#include "core/random.h"
#include "recording/rawlog.h"

// Time and peak memory of reading recordings of 1 min to 10 h (INS 100 Hz, DVL 5 Hz). Each is written and
// read by a child process of its own, so that its peak memory is its own. The ratio is that of the time a
// minute of recording takes to what it takes in the shortest one.
//   recording_bench [longest, minutes]
namespace {

using namespace fathom;
using namespace fathom::test;
using Clock = std::chrono::steady_clock;

constexpr int kInsPerSecond = 100;
constexpr int kInsPerDvl = 20;

struct Figures {
  double write_s = 0, read_s = 0;
  double write_peak_mb = 0, read_peak_mb = 0;
  double file_mb = 0;
  std::uint64_t entries = 0;
};

void writeRecording(const std::filesystem::path& file, int minutes, Figures& figures) {
  const auto begin = Clock::now();
  Random random(1);
  const Time start = fromUnixSeconds(1'700'000'000.0);
  RawlogWriter writer(file, {"", "", "bench"}, start);
  for (int i = 0; i < minutes * 60 * kInsPerSecond; ++i) {
    const Time time = after(start, i / static_cast<double>(kInsPerSecond));
    writer.write({time, labels::kIns, InsSample{{}, 0.1 * random.normal3(), random.normal3(), {}}});
    if (i % kInsPerDvl == 0) writer.write({time, labels::kDvl, DvlSample{{}, random.normal3()}});
  }
  writer.finish();
  figures.write_s = secondsSince(begin);
  figures.write_peak_mb = peakMegabytes();
  figures.file_mb = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
}

void readRecording(const std::filesystem::path& file, Figures& figures) {
  const auto begin = Clock::now();
  RawlogReader reader(file);
  while (reader.next()) ++figures.entries;
  figures.read_s = secondsSince(begin);
  figures.read_peak_mb = peakMegabytes();
  if (reader.loss()) std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  const int longest_min = argc > 1 ? std::atoi(argv[1]) : 600;
  const auto folder =
      std::filesystem::temp_directory_path() / ("recording_bench." + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto file = folder / "bench.rawlog";
  std::printf("%8s %9s %9s | %8s %9s | %8s %9s %8s %6s\n", "minutes", "entries", "file MB", "write s",
              "peak MB", "read s", "peak MB", "ms/min", "ratio");
  int status = 0;
  double first_ms_per_min = 0;
  for (const int minutes : {1, 10, 100, 600}) {
    if (minutes > longest_min) break;
    Figures f;
    const bool done = inChild(f, [&](Figures& out) { writeRecording(file, minutes, out); }) &&
                      inChild(f, [&](Figures& out) { readRecording(file, out); });
    if (!done) {
      std::fprintf(stderr, "recording_bench: %d minutes failed\n", minutes);
      status = 1;
      break;
    }
    const double ms_per_min = 1e3 * f.read_s / minutes;
    if (first_ms_per_min == 0) first_ms_per_min = ms_per_min;
    std::printf("%8d %9llu %9.1f | %8.2f %9.1f | %8.2f %9.1f %8.2f %6.2f\n", minutes,
                static_cast<unsigned long long>(f.entries), f.file_mb, f.write_s, f.write_peak_mb, f.read_s,
                f.read_peak_mb, ms_per_min, ms_per_min / first_ms_per_min);
    std::fflush(stdout);
  }
  std::filesystem::remove_all(folder);
  return status;
}
