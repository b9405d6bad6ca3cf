#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "core/random.h"
#include "localization/localizer.h"
#include "recording/rawlog.h"
#include "recording/recording_info.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "support/run_program.h"
#include "support/shared_data.h"

// Damaged rawlogs, all the way through `localize`: what is left is localized, or one clear line says why not.
namespace fathom::test {
namespace {

namespace fs = std::filesystem;

constexpr int kDamagedFiles = 200;

class LocalizeFuzz : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path config = fs::path(FATHOM_SOURCE_DIR) / "config";
    SimulationOptions options;
    options.vehicle = readVehicle(config / "rov.yaml");
    options.duration_s = 8.0;
    folder_ = scratchFolder();
    const auto files = simulateRecording(options, readTrajectory(config / "dive_trajectory.yaml"),
                                         {folder_, "short", config / "rov.yaml", "", "fuzz", std::nullopt});
    bytes_ = readTextFile(files.rawlog);
    vehicle_ = options.vehicle;
  }

  /// What `fathom localize` does with a recording before it writes anything. True: localized; false: refused
  /// by an Error or by a summary that says why. Anything else fails the test, by leaving it.
  bool localizeDamaged(const std::string& bytes) {
    const fs::path file = folder_ / "damaged.rawlog";
    fs::remove(file);
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      inspectRecording(file);
      RawlogReader reader(file);
      auto first = reader.next();
      if (!first) return false;
      LocalizationSetup setup;
      setup.vehicle = vehicle_;
      setup.time_zero = first->time;
      LocalizationSink sink;
      sink.estimate = [](const Estimate& e) { EXPECT_TRUE(e.state.motion.position_odom.allFinite()); };
      const auto summary = localize(
          setup, [&] { return first ? std::exchange(first, std::nullopt) : reader.next(); }, sink);
      if (!summary.started) {
        EXPECT_FALSE(summary.failure.empty());
      }
      return summary.started;
    } catch (const Error& error) {
      EXPECT_FALSE(error.why.empty());
      return false;
    }
  }

  fs::path folder_;
  std::string bytes_;
  Vehicle vehicle_;
};

std::string flipped(std::string bytes, Random& random) {
  auto& byte = bytes[random.bits() % bytes.size()];
  byte = static_cast<char>(byte ^ static_cast<char>(1 + random.bits() % 255));
  return bytes;
}

TEST_F(LocalizeFuzz, Cuts) {
  Random random(21);
  int localized = 0;
  for (int run = 0; run < kDamagedFiles; ++run)
    localized += localizeDamaged(bytes_.substr(0, random.bits() % bytes_.size()));
  EXPECT_GT(localized, kDamagedFiles / 4);  // what lies before the cut counts
}

TEST_F(LocalizeFuzz, Flips) {
  Random random(22);
  int localized = 0;
  for (int run = 0; run < kDamagedFiles; ++run) localized += localizeDamaged(flipped(bytes_, random));
  EXPECT_GT(localized, kDamagedFiles / 4);
}

// The program itself: status 0 or 2, and at most one line on stderr.
TEST_F(LocalizeFuzz, TheProgramSaysItInOneLine) {
  Random random(23);
  for (int run = 0; run < 6; ++run) {
    const fs::path file = folder_ / "damaged.rawlog";
    fs::remove(file);
    std::ofstream(file, std::ios::binary)
        << (run % 2 == 0 ? bytes_.substr(0, random.bits() % bytes_.size()) : flipped(bytes_, random));
    const ProgramResult result = runFathom("localize " + shellQuoted(file.string()) + " --vehicle " +
                                           shellQuoted(std::string(FATHOM_SOURCE_DIR) + "/config/rov.yaml") +
                                           " --out " + shellQuoted((folder_ / "out").string()));
    EXPECT_TRUE(result.status == 0 || result.status == 2) << result.err;
    EXPECT_LE(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    if (result.status == 2) {
      EXPECT_NE(result.err.find("damaged.rawlog"), std::string::npos) << result.err;
    }
  }
}

}  // namespace
}  // namespace fathom::test
