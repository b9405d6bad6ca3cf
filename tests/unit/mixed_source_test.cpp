#include "sources/mixed_source.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/error.h"
#include "core/files.h"
#include "recording/tum.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "sources/make_source.h"
#include "support/shared_data.h"
#include "support/simulated.h"
#include "support/streams.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using test::at;
using test::labelled;

Sample depth(double seconds, double pressure_pa) {
  return {at(seconds), labels::kDepth, DepthSample{{}, pressure_pa, {}}};
}
Sample dvl(double seconds, double x) { return {at(seconds), labels::kDvl, DvlSample{{}, Vector3d(x, 0, 0)}}; }
Sample image(double seconds, const std::string& file) {
  return {at(seconds), labels::kCamera, ImageSample{{}, {}, file}};
}

std::unique_ptr<SampleSource> list(std::vector<Sample> samples) {
  return std::make_unique<test::ListSource>(std::move(samples));
}

TEST(MixedSource, TakesEachSensorFromItsSourceInTimeOrder) {
  std::vector<MixedSource::Part> parts;
  parts.push_back({list({dvl(0.5, 2), depth(0.6, 2), dvl(1.0, 2), dvl(3.5, 2)}), {labels::kDvl}});
  parts.push_back({list({image(1.0, "a.png"), image(2.0, "/b.png")}), {labels::kCamera}});
  MixedSource mix(list({depth(0, 1), dvl(0, 1), depth(1, 1), image(1, "old.png"), depth(2, 1), dvl(3, 1)}),
                  std::move(parts));
  const auto samples = test::drain(mix);
  std::vector<std::string> order;
  for (const Sample& s : samples)
    order.push_back(s.label + std::to_string(secondsBetween(test::kStart, s.time)).substr(0, 3));
  EXPECT_EQ(order, (std::vector<std::string>{"DEPTH0.0", "DVL0.5", "DEPTH1.0", "DVL1.0", "CAMERA1.0",
                                             "DEPTH2.0", "CAMERA2.0", "DVL3.5"}));
  for (const Sample& s : labelled(samples, labels::kDvl))
    EXPECT_EQ(std::get<DvlSample>(s.reading).velocity_dvl->x(), 2);
  const auto images = labelled(samples, labels::kCamera);
  EXPECT_EQ(std::get<ImageSample>(images[0].reading).file, "/images/a.png");
  EXPECT_EQ(std::get<ImageSample>(images[1].reading).file, "/b.png");
}

TEST(MixedSource, TheMainSourcesOrderAndImageNamesStay) {
  const std::vector<Sample> samples{depth(0, 1), depth(2, 1), depth(1, 1),
                                    image(3, "a.png")};  // late by stamp
  MixedSource mix(list(samples), {});
  EXPECT_EQ(test::fingerprints(test::drain(mix)), test::fingerprints(samples));
  EXPECT_EQ(mix.imageFolder(), "/images");
  EXPECT_EQ(mix.header().description, "a list");
}

TEST(MixedSource, ALabelHasOneSource) {
  std::vector<MixedSource::Part> parts;
  parts.push_back({list({}), {labels::kDvl}});
  parts.push_back({list({}), {labels::kDvl}});
  EXPECT_THROW(MixedSource(list({}), std::move(parts)), std::logic_error);
}

// ---- makeSource

/// A simulated dive of ten seconds with its vehicle file, in a folder of its own.
struct Dive {
  fs::path folder = test::scratchFolder();
  SimulationOptions options;
  RecordingFiles files;

  Dive() {
    const fs::path config = fs::path(FATHOM_SOURCE_DIR) / "config";
    options.vehicle = readVehicle(config / "rov.yaml");
    options.duration_s = 10;
    options.begin_s = 20;
    const Trajectory trajectory = readTrajectory(config / "dive_trajectory.yaml");
    files = simulateRecording(options, trajectory, {folder, "dive", config / "rov.yaml", {}, "", {}});
  }
  std::vector<Sample> recorded() const {
    RecordingSource source(files.rawlog);
    return test::drain(source);
  }
  std::unique_ptr<SampleSource> make(const std::string& yaml) const {
    writeTextFile(folder / "sources.yaml", yaml);
    return makeSource(folder / "sources.yaml", files.rawlog);
  }
  std::vector<Sample> made(const std::string& yaml) const { return test::drain(*make(yaml)); }
  std::string complaint(const std::string& yaml) const {
    try {
      make(yaml);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST(MakeSource, TheRecordingIsTheDefault) {
  const Dive dive;
  EXPECT_EQ(test::fingerprints(dive.made("default: recording\n")), test::fingerprints(dive.recorded()));
  EXPECT_EQ(test::fingerprints(dive.made("from: {}\n")), test::fingerprints(dive.recorded()));
}

TEST(MakeSource, SimulatedSensorsCarryTheRecordingsTimes) {
  const Dive dive;
  for (const char* trajectory : {"recording", "dive.rawlog", "dive_truth.tum"}) {
    const auto samples = dive.made(
        std::string("from: {DVL: simulation}\nsimulation: {noise: false, trajectory: ") + trajectory + "}\n");
    const auto recorded = dive.recorded();
    for (const char* label : {labels::kIns, labels::kDvlBeams, labels::kDepth, labels::kTruth})
      EXPECT_EQ(test::fingerprints(labelled(samples, label)), test::fingerprints(labelled(recorded, label)));
    const auto simulated = labelled(samples, labels::kDvl), before = labelled(recorded, labels::kDvl);
    ASSERT_EQ(simulated.size(), before.size());
    double square = 0;
    for (std::size_t i = 0; i < simulated.size(); ++i) {
      EXPECT_EQ(simulated[i].time, before[i].time);
      const Vector3d difference = *std::get<DvlSample>(simulated[i].reading).velocity_dvl -
                                  *std::get<DvlSample>(before[i].reading).velocity_dvl;
      square += difference.squaredNorm() / static_cast<double>(simulated.size());
    }
    // What is left is the recording's own noise: 0.0099 m/s in two axes, 0.00404 in one; 51 readings.
    EXPECT_NEAR(std::sqrt(square), std::sqrt(2 * 0.0099 * 0.0099 + 0.00404 * 0.00404), 0.003);
    for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_LE(samples[i - 1].time, samples[i].time);
  }
}

TEST(MakeSource, EverythingSimulated) {
  const Dive dive;
  const auto source = dive.make(
      "default: simulation\nsimulation: {trajectory: recording, vehicle: dive_vehicle.yaml, seed: 1}\n");
  EXPECT_EQ(source->header().vehicle, "dive_vehicle.yaml");
  auto samples = test::drain(*source), recorded = dive.recorded();
  std::erase_if(recorded, [](const Sample& s) { return std::holds_alternative<RecordingHeader>(s.reading); });
  ASSERT_EQ(samples.size(), recorded.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].time, recorded[i].time);
    EXPECT_EQ(samples[i].label, recorded[i].label);
  }
}

TEST(MakeSource, ACalibrationSwitchesEffectsOn) {
  const Dive dive;
  writeTextFile(dive.folder / "scale.yaml", "effects:\n  - {id: dvl-scale, scale_error: 0.1}\n");
  const std::string mix = "from: {DVL: simulation}\nsimulation: {trajectory: recording, noise: false";
  const auto plain = labelled(dive.made(mix + "}\n"), labels::kDvl);
  const auto scaled = labelled(dive.made(mix + ", calibration: scale.yaml}\n"), labels::kDvl);
  ASSERT_EQ(plain.size(), scaled.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const Vector3d v = *std::get<DvlSample>(plain[i].reading).velocity_dvl;
    EXPECT_LT((1.1 * v - *std::get<DvlSample>(scaled[i].reading).velocity_dvl).norm(), 1e-12);
  }
}

TEST(MakeSource, ImagesOfAnotherRecordingKeepTheirFolder) {
  const Dive dive;
  const Time start = dive.options.start;
  const std::vector<Sample> images{{after(start, 1), labels::kCamera, ImageSample{{}, {}, "x.png"}}};
  {
    RawlogWriter writer(dive.folder / "camera.rawlog", {}, start);
    for (const Sample& s : images) writer.write(s);
    writer.finish();
  }
  const auto samples = labelled(dive.made("from: {CAMERA: camera.rawlog}\n"), labels::kCamera);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(std::get<ImageSample>(samples[0].reading).file,
            fs::absolute(dive.folder / "camera_Images" / "x.png").string());
}

TEST(MakeSource, SaysWhatIsWrong) {
  const Dive dive;
  {
    RawlogWriter writer(dive.folder / "elsewhen.rawlog", {}, fromUnixSeconds(1e9));
    writer.write({fromUnixSeconds(1e9), labels::kDepth, DepthSample{{}, 1e5, {}}});
    writer.finish();
  }
  writeTum(dive.folder / "elsewhen.tum", {{fromUnixSeconds(1e9), {}},
                                          {fromUnixSeconds(1e9 + 1), {}},
                                          {fromUnixSeconds(1e9 + 2), {}},
                                          {fromUnixSeconds(1e9 + 3), {}}});
  const auto says = [&](const std::string& yaml, const std::string& what) {
    EXPECT_NE(dive.complaint(yaml).find(what), std::string::npos) << yaml << " -> " << dive.complaint(yaml);
  };
  const std::string simulation = "simulation: {trajectory: recording}\n";
  says("defualt: recording\n", "unknown key; did you mean `default`?");
  says("from: {DLV: recording}\n", "DLV (line 1): is no sensor that a recording has: ALTIMETER");
  says("from: {LANDMARKS: recording}\n", "is no sensor that a recording has");
  says("from: {DVL: simulation}\n", "missing key `simulation`");
  says(simulation, "is not used");
  says("from: {DVL: simulation}\nsimulation: {trajectory: recording, speed: 1}\n", "unknown key");
  says("from: {DVL: simulation}\nsimulation: {seed: 1}\n", "missing key `trajectory`");
  says("from: {DVL: simulation}\nsimulation: {trajectory: recording, seed: -1}\n", "must not be negative");
  says("from: {USBL: simulation}\n" + simulation, "there is no USBL in the simulated vehicle");
  says("from: {CAMERA: simulation}\n" + simulation, "images cannot be simulated on the way");
  says("from: {USBL: dive.rawlog}\n", "there is no USBL in");
  says("from: {DEPTH: missing.rawlog}\n", "there is no rawlog");
  says("default: somewhere\n", "must be recording, simulation or a rawlog");
  says("from: {DEPTH: elsewhen.rawlog}\n", "has no time in common with");
  says("from: {DVL: simulation}\nsimulation: {trajectory: elsewhen.tum}\n", "has no time in common with");
}

}  // namespace
}  // namespace fathom
