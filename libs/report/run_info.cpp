#include "report/run_info.h"

#include <nlohmann/json.hpp>

#include "core/files.h"

namespace fathom {

nlohmann::ordered_json vectorJson(const Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

nlohmann::ordered_json toJson(const RunInfo& run) {
  nlohmann::ordered_json json;
  json["program"] = "fathom";
  json["version"] = run.version;
  json["command_line"] = run.command_line;
  json["seed"] = run.seed ? nlohmann::ordered_json(*run.seed) : nlohmann::ordered_json(nullptr);
  return json;
}

void writeJson(const std::filesystem::path& file, const nlohmann::ordered_json& value) {
  writeTextFile(file, value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace fathom
