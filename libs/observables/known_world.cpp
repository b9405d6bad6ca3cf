#include "observables/known_world.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {
using nlohmann::json;

/// What `tell` makes of NAME_simulation.json beside the rawlog; nothing where there is no such file.
template <class Tell>
auto fromSimulation(const fs::path& rawlog, const std::string& what, const Tell& tell)
    -> decltype(tell(json())) {
  const fs::path file = rawlog.parent_path() / (rawlog.stem().string() + "_simulation.json");
  if (!isThere(file)) return std::nullopt;
  try {
    return tell(json::parse(readTextFile(file)));
  } catch (const json::exception& problem) {
    throw Error(file.string(), "", "does not tell the " + what + ": " + problem.what());
  }
}

Vector3d colourOf(const json& rgb) {
  return {rgb.at(0).get<double>(), rgb.at(1).get<double>(), rgb.at(2).get<double>()};
}

}  // namespace

std::optional<KnownSeaFloor> seaFloorOf(const fs::path& rawlog) {
  return fromSimulation(rawlog, "sea floor", [](const json& simulation) {
    return std::optional(KnownSeaFloor{simulation.at("sea_floor_z_m").get<double>(),
                                       simulation.at("run").at("seed").get<std::uint64_t>()});
  });
}

std::optional<Environment> trueEnvironment(const fs::path& rawlog) {
  return fromSimulation(rawlog, "water", [](const json& simulation) -> std::optional<Environment> {
    if (!simulation.contains("environment")) return std::nullopt;
    const json& known = simulation.at("environment");
    return Environment{{colourOf(known.at("attenuation_per_m")), colourOf(known.at("veil"))},
                       colourOf(known.at("ambient")),
                       {}};
  });
}

}  // namespace fathom
