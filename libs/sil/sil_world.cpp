#include "sil/sil_world.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"

namespace fathom {
namespace fs = std::filesystem;

std::optional<KnownSeaFloor> seaFloorOf(const fs::path& rawlog) {
  const fs::path file = rawlog.parent_path() / (rawlog.stem().string() + "_simulation.json");
  if (!fs::exists(file)) return std::nullopt;
  try {
    const auto json = nlohmann::json::parse(readTextFile(file));
    return KnownSeaFloor{json.at("sea_floor_z_m").get<double>(),
                         json.at("run").at("seed").get<std::uint64_t>()};
  } catch (const nlohmann::json::exception& problem) {
    throw Error(file.string(), "", std::string("does not tell the sea floor: ") + problem.what());
  }
}

}  // namespace fathom
