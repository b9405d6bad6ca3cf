// Damaged files of faults, stress and sources: an Error of one line or something that runs, and nothing else.
#include <gtest/gtest.h>

#include <functional>

#include "core/error.h"
#include "core/files.h"
#include "core/random.h"
#include "recording/tum.h"
#include "sources/make_source.h"
#include "sources/stress.h"
#include "support/damaged_text.h"
#include "support/motions.h"
#include "support/shared_data.h"
#include "support/streams.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const fs::path kSource = FATHOM_SOURCE_DIR;

/// Damages `text` again and again; `use` gets the file. Some must be read and some rejected.
void fuzz(const fs::path& folder, const std::string& text, int rounds,
          const std::function<void(const fs::path&)>& use) {
  Random random(1);
  const fs::path file = folder / "damaged.yaml";
  int read = 0;
  for (int i = 0; i < rounds; ++i) {
    std::string worse = test::damaged(text, random);
    if (i % 2 == 0 && !worse.empty()) worse = test::damaged(worse, random);
    writeTextFile(file, worse);
    try {
      use(file);
      ++read;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << worse << "\n" << error.what();
    }
  }
  EXPECT_GT(read, 0);
  EXPECT_LT(read, rounds);
}

TEST(SourcesFuzz, Degradation) {
  const auto samples = test::everySensor(2);
  for (const char* name : {"degrade_poor_bus.yaml", "degrade_landmarks.yaml", "degrade_bottom_lock.yaml"})
    fuzz(test::scratchFolder(), readTextFile(kSource / "config" / name), 200,
         [&](const fs::path& file) { test::degraded(samples, readDegradation(file)); });
}

TEST(SourcesFuzz, Stress) {
  const auto samples = test::everySensor(2);
  const std::string text =
      "faults:\n"
      "  - {name: a, kind: bias, sensors: [INS], gyro_rad_s: [0, 0, 1], vary: gyro_rad_s, strengths: [1, 2, "
      "3]}\n"
      "  - {name: b, kind: corrupt, sensors: [LANDMARKS], as: [wild], vary: probability, strengths: [0.1, "
      "1]}\n"
      "  - {name: c, kind: noise, sensors: [DVL_BEAMS], range_m: 1, vary: factor, strengths: [0.1, 1]}\n";
  fuzz(test::scratchFolder(), text, 300, [&](const fs::path& file) {
    for (const StressFault& fault : readStress(file))
      for (const double strength : fault.strengths) test::degraded(samples, {fault.at(strength)});
  });
}

TEST(SourcesFuzz, Sources) {
  const fs::path folder = test::scratchFolder(), recording = folder / "dive.rawlog";
  std::vector<Sample> dive = test::everySensor(3);
  std::erase_if(dive, [](const Sample& s) { return s.label == labels::kPanel; });  // never recorded
  test::writeRecording(recording, dive);
  std::vector<StampedPose> poses;
  for (const double t : test::timesBetween(0, 4, 0.5)) poses.push_back({test::at(t), test::sinePose(t)});
  writeTum(folder / "truth.tum", poses);
  fs::copy_file(kSource / "config/rov.yaml", folder / "rov.yaml");
  const std::string text =
      "default: recording\nfrom: {DVL: simulation, DEPTH: simulation, INS: dive.rawlog, USBL: recording}\n"
      "simulation:\n  trajectory: truth.tum\n  vehicle: rov.yaml\n  seed: 4\n  noise: true\n"
      "  sea_floor_z_m: -6.5\n";
  fuzz(folder, text, 300, [&](const fs::path& file) {
    const auto source = makeSource(file, recording);
    double newest = 0;
    while (const auto sample = source->next()) {
      EXPECT_GE(secondsBetween(test::kStart, sample->time), newest);
      newest = secondsBetween(test::kStart, sample->time);
    }
  });
}

}  // namespace
}  // namespace fathom
