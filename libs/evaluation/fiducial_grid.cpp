#include "evaluation/fiducial_grid.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "core/yaml.h"
#include "panel/marker_family.h"

namespace fathom {
namespace {

constexpr double kSteepest_deg = 85;

template <class Kind, std::size_t count>
Kind named(const std::string& name, const Kind (&kinds)[count]) {
  std::string known;
  for (const Kind kind : kinds) {
    if (name == nameOf(kind)) return kind;
    known += (known.empty() ? "" : ", ") + std::string(nameOf(kind));
  }
  throw std::invalid_argument("`" + name + "` is none of " + known);
}

/// A list with at least one entry and none of them twice, each made from its YAML form.
template <class Value, class Entry>
void readList(const YamlMap& y, const std::string& key, const std::vector<Entry>& entries,
              const std::function<Value(const Entry&)>& make, std::vector<Value>& values) {
  if (entries.empty()) throw y.error(key, "must have at least one entry");
  values.clear();
  for (const Entry& entry : entries) {
    try {
      const Value value = make(entry);
      if (std::find(values.begin(), values.end(), value) != values.end())
        throw std::invalid_argument("has an entry twice");
      values.push_back(value);
    } catch (const std::invalid_argument& problem) {
      throw y.error(key, problem.what());
    }
  }
}

template <class Value>
void readNames(const YamlMap& y, const std::string& key, const std::function<Value(const std::string&)>& make,
               std::vector<Value>& values) {
  if (y.has(key)) readList<Value, std::string>(y, key, y.texts(key), make, values);
}

void readNumbers(const YamlMap& y, const std::string& key, double low, double high, double unit,
                 std::vector<double>& values) {
  const auto checked = [&](const double& number) {
    if (number < low || number > high)
      throw std::invalid_argument("must be between " + std::to_string(low) + " and " + std::to_string(high));
    return number * unit;
  };
  if (y.has(key)) readList<double, double>(y, key, y.numbers(key), checked, values);
}

Vector3d readColour(const YamlMap& y, const std::string& key) {
  Vector3d colour = y.vector3(key);
  if (colour.minCoeff() < 0) throw y.error(key, "must not be below zero");
  return colour;
}

NamedWater readWater(const YamlMap& y) {
  NamedWater water{y.text("name"), {readColour(y, "attenuation_per_m"), readColour(y, "veil")}, {}};
  water.ambient = readColour(y, "ambient");
  if (water.name.find_first_of(",\"\n") != std::string::npos)
    throw y.error("name", "must have no comma or quote");
  if (water.water.veil.maxCoeff() > 1) throw y.error("veil", "must not be above 1, the camera's full scale");
  return water;
}

void readWaters(const YamlMap& y, std::vector<NamedWater>& waters) {
  if (!y.has("waters")) return;
  waters.clear();
  for (const YamlMap& entry : y.maps("waters")) {
    NamedWater water = readWater(entry);
    for (const NamedWater& other : waters)
      if (other.name == water.name) throw entry.error("name", "there are two waters `" + water.name + "`");
    waters.push_back(std::move(water));
  }
  if (waters.empty()) throw y.error("waters", "must have at least one entry");
}

}  // namespace

std::string FiducialReader::name() const {
  const std::string library(nameOf(backend));
  return preprocess == Preprocess::none ? library : library + "+" + std::string(nameOf(preprocess));
}

std::vector<FiducialReader> readersOf(const std::vector<Backend>& backends,
                                      const std::vector<Preprocess>& preprocessings) {
  std::vector<FiducialReader> readers;
  for (const Backend backend : backends)
    for (const Preprocess preprocess : preprocessings) readers.push_back({backend, preprocess});
  return readers;
}

std::unique_ptr<Detector> makeDetector(const FiducialReader& reader, const std::vector<std::string>& families,
                                       const MarkerLook& look, const CameraModel& camera) {
  DetectorOptions options;
  options.look = look;
  options.preprocess = reader.preprocess;
  options.refine = hasRoughCorners(reader.backend);
  options.camera = camera;
  return makeDetector(reader.backend, families, options);
}

Preprocess preprocessNamed(const std::string& name) {
  return named(name, {Preprocess::none, Preprocess::stretch, Preprocess::clahe});
}

std::string complaintAbout(const std::vector<std::string>& families, const std::vector<Backend>& backends) {
  if (families.empty()) return "must have at least one entry";
  for (const auto& family : families) {
    if (!isMarkerFamily(family)) return "no such marker family: `" + family + "`";
    if (std::count(families.begin(), families.end(), family) > 1) return "has " + family + " twice";
    for (const Backend backend : backends)
      if (!canRead(backend, family))
        return "the " + std::string(nameOf(backend)) + " backend cannot read " + family +
               "; leave one of them out";
  }
  return "";
}

FiducialGrid readFiducialGrid(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  FiducialGrid grid;
  if (y.has("families")) grid.families = y.texts("families");
  readNames<Backend>(y, "backends", backendNamed, grid.backends);
  readNames<Preprocess>(y, "preprocessings", preprocessNamed, grid.preprocessings);
  readNumbers(y, "ranges_m", 0.1, 100, 1, grid.ranges_m);
  readNumbers(y, "tilts_deg", 0, kSteepest_deg, radians(1), grid.tilts_rad);
  readWaters(y, grid.waters);
  readNumbers(y, "blurs_px", 0, 20, 1, grid.blurs_px);
  y.read("repeats", grid.repeats);
  if (grid.repeats < 1 || grid.repeats > 1000) throw y.error("repeats", "must be between 1 and 1000");
  if (y.has("match_px")) grid.match_px = y.positive("match_px");
  int seed = static_cast<int>(grid.seed);
  y.read("seed", seed);
  if (seed < 0) throw y.error("seed", "must not be negative");
  grid.seed = static_cast<std::uint64_t>(seed);
  yaml.rejectUnknownKeys();
  if (const auto why = complaintAbout(grid.families, grid.backends); !why.empty())
    throw y.error("families", why);
  return grid;
}

}  // namespace fathom
