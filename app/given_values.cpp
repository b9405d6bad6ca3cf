#include "given_values.h"

#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "core/files.h"

namespace fathom {
namespace {

std::string finite(std::string text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && !std::isfinite(value))
    throw CLI::ValidationError("must be a finite number, not " + text);
  return text;
}

/// Whether a file is named as those are that a command writes into a folder: NAME.rawlog, NAME_truth.tum.
bool isAmongOutputs(const std::string& file, const std::string& folder, const std::string& name) {
  std::error_code nobody_can_look;
  const std::filesystem::path path(file), parent = path.has_parent_path() ? path.parent_path() : ".";
  const std::string own = path.filename().string();
  return isFile(path) && own.size() > name.size() && own.starts_with(name) &&
         (own[name.size()] == '.' || own[name.size()] == '_') &&
         std::filesystem::equivalent(parent, folder, nobody_can_look);
}

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code nobody_can_look;
  return isFile(a) && isFile(b) && std::filesystem::equivalent(a, b, nobody_can_look);
}

}  // namespace

void refuseNonFinite(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    refuseNonFinite(*command);
    for (CLI::Option* option : command->get_options())
      if (option->get_type_name().starts_with("FLOAT")) option->transform(finite, "");
  }
}

void refuseOutputOverInput(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    refuseOutputOverInput(*command);
    const CLI::Option* out = command->get_option_no_throw("--out");
    if (out == nullptr) continue;
    const CLI::Option* name = command->get_option_no_throw("--name");
    for (const CLI::Option* option : command->get_options())
      for (const std::string& value : option->results())
        for (const std::string& target : out->results())
          if (option != out &&
              (isSameFile(target, value) || (name != nullptr && name->count() > 0 &&
                                             isAmongOutputs(value, target, name->as<std::string>()))))
            throw Error("--out", target,
                        "is what " + option->get_name() + " names: an input is not written over");
  }
}

}  // namespace fathom
