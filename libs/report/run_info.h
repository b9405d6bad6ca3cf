#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/geometry.h"
#include "core/version.h"

namespace fathom {

/// What it takes to repeat a run; stands in every result.json and at the foot of every report.
struct RunInfo {
  std::string command_line{};
  std::optional<std::uint64_t> seed{};  ///< absent: nothing in the run is random
  std::string version = programVersion();
};

/// {"program": "fathom", "version": …, "command_line": …, "seed": … or null}
nlohmann::ordered_json toJson(const RunInfo& run);

/// [x, y, z]
nlohmann::ordered_json vectorJson(const Vector3d& vector);

/// Two spaces an indent, keys in the order given, NaN and infinity as null, broken UTF-8 replaced; written by
/// way of PendingFile. The same value gives the same bytes. Throws Error.
void writeJson(const std::filesystem::path& file, const nlohmann::ordered_json& value);

}  // namespace fathom
