#include "sources/make_source.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/files.h"
#include "effects/calibration.h"
#include "recording/instrument_entries.h"
#include "recording/rawlog.h"
#include "sources/mixed_source.h"
#include "sources/simulated_source.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecording = "recording";
constexpr const char* kSimulation = "simulation";
const std::set<std::string> kSensors = [] {
  const std::vector<std::string> instruments = instrumentLabels();
  std::set<std::string> all{labels::kCamera, labels::kStereo, labels::kTruth};
  all.insert(instruments.begin(), instruments.end());
  return all;
}();
const std::set<std::string> kImages{labels::kCamera, labels::kStereo};

/// What a recording holds: from when to when, and which labels.
struct Contents {
  Time first{}, last{};
  std::set<std::string> labels;
};

Contents contentsOf(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  Contents contents;
  while (const auto sample = reader.next()) {
    contents.labels.insert(sample->label);
    if (sample->time == Time{} || std::holds_alternative<RecordingHeader>(sample->reading)) continue;
    if (contents.first == Time{}) contents.first = sample->time;
    contents.last = std::max(contents.last, sample->time);
  }
  return contents;
}

std::set<std::string> sensorsOf(const Vehicle& vehicle) {
  std::set<std::string> sensors{labels::kTruth};
  forEachInstrument([&]<class Instrument>() {
    vehicle.forEachInstance([&](const Instance& instance, const SensorsOnBoard& on_board) {
      const auto& sheet = on_board.*Instrument::on_board;
      if (sheet && !Instrument::mountings(*sheet).empty()) sensors.insert(instance.label(Instrument::label));
    });
  });
  return sensors;
}

/// Builds the sources that a file names.
class SourceMaker {
 public:
  SourceMaker(const YamlMap& map, fs::path folder, fs::path recording)
      : map_(map),
        folder_(std::move(folder)),
        recording_(std::move(recording)),
        contents_(contentsOf(recording_)) {}

  std::unique_ptr<SampleSource> make() const {
    std::string main = kRecording;
    map_.read("default", main);
    std::map<std::string, std::vector<std::string>> labels;  // of each source that is not the main one
    for (const auto& [label, source] : wanted())
      if (source != main) labels[source].push_back(label);
    if (main != kSimulation && !labels.contains(kSimulation) && map_.has(kSimulation))
      throw map_.error(kSimulation, "is not used: neither `default` nor `from` names it");

    auto main_source = source(main, {}, map_, "default");
    if (labels.empty()) return main_source;
    std::vector<MixedSource::Part> parts;
    parts.reserve(labels.size());
    for (const auto& [name, wanted_labels] : labels)
      parts.push_back({source(name, wanted_labels, map_.map("from"), wanted_labels.front()), wanted_labels});
    return std::make_unique<MixedSource>(std::move(main_source), std::move(parts));
  }

 private:
  /// Label to source, as `from` says.
  std::map<std::string, std::string> wanted() const {
    std::map<std::string, std::string> sources;
    if (!map_.has("from")) return sources;
    const YamlMap from = map_.map("from");
    for (const std::string& label : from.keys()) {
      if (!kSensors.contains(std::string(baseOf(label)))) {
        std::string known;
        for (const std::string& sensor : kSensors) known += (known.empty() ? "" : ", ") + sensor;
        throw from.error(label, "is no sensor that a recording has: " + known);
      }
      sources[label] = from.text(label);
    }
    return sources;
  }

  /// `at` and `key` say where the source is asked for, for errors.
  std::unique_ptr<SampleSource> source(const std::string& name, const std::vector<std::string>& wanted,
                                       const YamlMap& at, const std::string& key) const {
    if (name == kSimulation) return simulation(wanted, at);
    if (name == kRecording) {
      demand(contents_.labels, wanted, at, recording_.string());
      return std::make_unique<RecordingSource>(recording_);
    }
    const fs::path file = folder_ / name;
    if (file.extension() != ".rawlog" || !isThere(file))
      throw at.error(key, "must be recording, simulation or a rawlog; there is no rawlog " + file.string());
    const Contents contents = contentsOf(file);
    demand(contents.labels, wanted, at, file.string());
    if (contents.first > contents_.last || contents.last < contents_.first)
      throw at.error(key, file.string() + " has no time in common with " + recording_.string());
    return std::make_unique<RecordingSource>(file);
  }

  std::unique_ptr<SampleSource> simulation(const std::vector<std::string>& wanted, const YamlMap& at) const {
    const YamlMap y = map_.map(kSimulation);
    SimulationOptions options;
    const RecordingHeader header = RawlogReader(recording_).header();
    options.vehicle = readVehicle(vehicleFile(y, header));
    for (const std::string& label : wanted)
      if (kImages.contains(std::string(baseOf(label))))
        throw at.error(label, "images cannot be simulated on the way: simulate a recording and name it here");
    demand(sensorsOf(options.vehicle), wanted, at, "the simulated vehicle");
    if (y.has("calibration")) {
      const fs::path calibration = folder_ / y.text("calibration");
      options.effects = readCalibration(calibration);
      requireInstances(options.effects, options.vehicle, calibration.string());
    }
    if (y.has("seed")) options.seed = seedOf(y);
    y.read("noise", options.noise);
    y.read("sea_floor_z_m", options.sea_floor_z_m);

    const std::string trajectory = y.text("trajectory");
    RecordedMotion motion = readRecordedMotion(trajectory == kRecording ? recording_ : folder_ / trajectory);
    if (!alignTo(options, motion, contents_.first, contents_.last))
      throw y.error("trajectory", "has no time in common with " + recording_.string());
    return std::make_unique<SimulatedSource>(std::move(options), std::move(motion.trajectory), header);
  }

  fs::path vehicleFile(const YamlMap& y, const RecordingHeader& header) const {
    if (y.has("vehicle")) return folder_ / y.text("vehicle");
    if (!header.vehicle.empty()) return recording_.parent_path() / header.vehicle;
    throw y.error("", "missing key `vehicle`, and " + recording_.string() + " names no vehicle file");
  }

  static std::uint64_t seedOf(const YamlMap& y) {
    const int seed = y.integer("seed");
    if (seed < 0) throw y.error("seed", "must not be negative");
    return static_cast<std::uint64_t>(seed);
  }

  /// Throws where one of the labels wanted is not there. `where` names the place.
  static void demand(const std::set<std::string>& there, const std::vector<std::string>& wanted,
                     const YamlMap& at, const std::string& where) {
    for (const std::string& label : wanted)
      if (!there.contains(label))
        throw at.error(label, std::string("there is no ").append(label) + " in " + where);
  }

  const YamlMap& map_;
  fs::path folder_, recording_;
  Contents contents_;
};

}  // namespace

std::unique_ptr<SampleSource> makeSource(const YamlMap& map, const fs::path& folder,
                                         const fs::path& recording) {
  return SourceMaker(map, folder, recording).make();
}

std::unique_ptr<SampleSource> makeSource(const fs::path& file, const fs::path& recording) {
  const YamlFile yaml(file);
  auto source = makeSource(yaml.root(), file.parent_path(), recording);
  yaml.rejectUnknownKeys();
  return source;
}

}  // namespace fathom
