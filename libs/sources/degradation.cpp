#include "sources/degradation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

namespace fathom {
namespace {

using Labels = std::vector<std::string>;

const std::vector<std::string>& knownSensors() {
  static const std::vector<std::string> sensors = [] {
    std::vector<std::string> all = instrumentLabels();
    for (const char* label : {labels::kCamera, labels::kStereo, kLandmarks, labels::kMarkers, labels::kPanel})
      all.emplace_back(label);
    return all;
  }();
  return sensors;
}

bool standsFor(const std::string& sensor, const std::string& label) {
  const auto kind = baseOf(label);
  return sensor == label || (sensor == kLandmarks && (kind == labels::kMarkers || kind == labels::kPanel));
}

std::string join(std::span<const std::string> words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Why a value is not allowed; empty where it is.
std::string breach(double value, Limit limit) {
  if (!std::isfinite(value)) return "must be finite";
  if (limit == Limit::positive && !(value > 0)) return "must be greater than zero";
  if (limit != Limit::any && !(value >= 0)) return "must not be negative";
  if (limit == Limit::probability && value > 1) return "must be at most 1";
  return "";
}

/// Fills a fault from YAML.
class ReadFields {
 public:
  ReadFields(const YamlMap& map, const std::vector<std::string>& sensors, const std::string& vary)
      : map_(map), sensors_(sensors), vary_(vary) {}

  void strength(const char* key, double& value, Limit limit) {
    if (key != vary_ || map_.has(key)) value = checked(key, map_.number(key), limit);
  }
  void option(const char* key, double& value, Limit limit) {
    if (map_.has(key)) value = checked(key, map_.number(key), limit);
  }
  void amount(const char* key, const Labels& labels, double& value, Limit limit) {
    if (present(key, labels)) value = checked(key, map_.number(key), limit);
  }
  void amount(const char* key, const Labels& labels, Vector3d& value, Limit limit) {
    if (!present(key, labels)) return;
    value = map_.isList(key) ? map_.vector3(key) : Vector3d::Constant(map_.number(key));
    for (const double component : value) checked(key, component, limit);
  }
  template <class Choice>
  void choices(const char* key, std::span<const std::string_view> names, std::vector<Choice>& chosen) {
    if (!map_.has(key)) return;
    chosen.clear();
    for (const std::string& word : map_.texts(key)) {
      const auto it = std::find(names.begin(), names.end(), word);
      if (it == names.end())
        throw map_.error(
            key, "`" + word + "` is none of " + join(std::vector<std::string>(names.begin(), names.end())));
      chosen.push_back(static_cast<Choice>(it - names.begin()));
    }
    if (chosen.empty()) throw map_.error(key, "must not be empty");
  }

  /// Complains about a sensor that no amount is for.
  void finish() const {
    if (amounts_.empty()) return;
    for (const auto& [sensor, keys] : amounts_)
      if (!served_.contains(sensor)) throw map_.error("", "says nothing for " + sensor + ": " + join(keys));
  }

 private:
  bool present(const char* key, const Labels& labels) {
    const bool given = map_.has(key) || (key == vary_);
    bool wanted = false;
    for (const std::string& sensor : sensors_)
      for (const std::string& label : labels) {
        if (!standsFor(std::string(baseOf(sensor)), label)) continue;
        wanted = true;
        auto& keys = amounts_[sensor];
        if (keys.empty() || keys.back() != key) keys.emplace_back(key);
        if (given) served_[sensor] = true;
      }
    if (given && !wanted)
      throw map_.error(map_.has(key) ? key : "", std::string(key) + " concerns none of the stage's sensors");
    return map_.has(key);
  }
  double checked(const char* key, double value, Limit limit) const {
    if (const std::string why = breach(value, limit); !why.empty()) throw map_.error(key, why);
    return value;
  }

  const YamlMap& map_;
  const std::vector<std::string>& sensors_;
  const std::string& vary_;
  std::map<std::string, std::vector<std::string>> amounts_;  // of each sensor, the keys for it
  std::map<std::string, bool> served_;
};

struct ScaleFields {
  double factor;

  void strength(const char*, double& value, Limit limit) const {
    value *= factor;
    if (limit == Limit::probability) value = std::min(value, 1.0);
  }
  void option(const char*, double&, Limit) const {}
  void amount(const char*, const Labels&, double& value, Limit) const { value *= factor; }
  void amount(const char*, const Labels&, Vector3d& value, Limit) const { value *= factor; }
  void choices(const char*, const auto&, auto&) const {}
};

struct SetField {
  const std::string& key;
  double to;
  bool found = false;

  void strength(const char* name, double& value, Limit limit) {
    if (!matches(name, limit)) return;
    value = to;
  }
  void option(const char*, double&, Limit) const {}
  void amount(const char* name, const Labels&, double& value, Limit limit) { strength(name, value, limit); }
  void amount(const char* name, const Labels&, Vector3d& value, Limit limit) {
    if (!matches(name, limit)) return;
    const double largest = value.cwiseAbs().maxCoeff();
    value = largest > 0 ? Vector3d(value / largest * to) : Vector3d::Constant(to);
  }
  void choices(const char*, const auto&, auto&) const {}

 private:
  bool matches(const char* name, Limit limit) {
    if (key != name) return false;
    if (const std::string why = breach(to, limit); !why.empty()) throw std::invalid_argument(why);
    found = true;
    return true;
  }
};

struct ListStrengths {
  std::vector<std::string> keys;

  void strength(const char* key, double&, Limit) { keys.emplace_back(key); }
  void option(const char*, double&, Limit) const {}
  void amount(const char* key, const Labels&, const auto&, Limit) { keys.emplace_back(key); }
  void choices(const char*, const auto&, auto&) const {}
};

AnyFault faultOfKind(const YamlMap& map) {
  const std::string kind = map.text("kind");
  std::vector<std::string> known;
  std::optional<AnyFault> fault;
  forEachFault([&]<class Fault>() {
    known.emplace_back(Fault::id);
    if (kind == Fault::id) fault = Fault{};
  });
  if (!fault) throw map.error("kind", "`" + kind + "` is none of " + join(known));
  return *fault;
}

std::uint64_t readSeed(const YamlMap& map) {
  const int seed = map.integer("seed");
  if (seed < 0) throw map.error("seed", "must not be negative");
  return static_cast<std::uint64_t>(seed);
}

std::vector<std::string> readSensors(const YamlMap& map, bool with_values) {
  auto sensors = map.texts("sensors");
  if (sensors.empty()) throw map.error("sensors", "must not be empty");
  for (const std::string& sensor : sensors) {
    if (std::find(knownSensors().begin(), knownSensors().end(), std::string(baseOf(sensor))) ==
        knownSensors().end())
      throw map.error("sensors", "`" + sensor + "` is none of " + join(knownSensors()));
    if (with_values && !hasValues(sensor == kLandmarks ? labels::kMarkers : std::string(baseOf(sensor))))
      throw map.error("sensors", sensor + " has no values to change");
  }
  return sensors;
}

}  // namespace

std::string DegradationStage::kind() const {
  return std::visit([](const auto& f) { return std::string(f.id); }, fault);
}

bool DegradationStage::concerns(const std::string& label) const {
  return std::any_of(sensors.begin(), sensors.end(),
                     [&](const auto& sensor) { return standsFor(sensor, label); });
}

std::vector<std::string> DegradationStage::strengthKeys() const {
  ListStrengths list;
  std::visit([&](auto f) { f.fields(list); }, fault);
  return list.keys;
}

DegradationStage DegradationStage::scaled(double factor) const {
  DegradationStage stage = *this;
  ScaleFields scale{factor};
  std::visit([&](auto& f) { f.fields(scale); }, stage.fault);
  return stage;
}

DegradationStage DegradationStage::with(const std::string& key, double value) const {
  DegradationStage stage = *this;
  SetField set{key, value};
  std::visit([&](auto& f) { f.fields(set); }, stage.fault);
  if (!set.found) throw std::invalid_argument("`" + key + "` is no strength of " + kind());
  return stage;
}

DegradationStage parseDegradationStage(const YamlMap& map, const std::string& vary) {
  DegradationStage stage;
  stage.fault = faultOfKind(map);
  const bool changes_values = std::visit([](const auto& f) { return f.changes_values; }, stage.fault);
  stage.sensors = readSensors(map, changes_values);
  map.read("begin_s", stage.begin_s);
  map.read("end_s", stage.end_s);
  if (!(stage.end_s > stage.begin_s)) throw map.error("end_s", "must be later than begin_s");
  if (map.has("seed")) stage.seed = readSeed(map);
  ReadFields fields(map, stage.sensors, vary);
  std::visit([&](auto& f) { f.fields(fields); }, stage.fault);
  fields.finish();
  return stage;
}

std::vector<DegradationStage> readDegradation(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  std::vector<DegradationStage> stages;
  for (const YamlMap& map : yaml.root().maps("stages")) stages.push_back(parseDegradationStage(map));
  yaml.rejectUnknownKeys();
  return stages;
}

}  // namespace fathom
