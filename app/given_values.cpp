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
    for (const CLI::Option* option : command->get_options())
      for (const std::string& value : option->results())
        for (const std::string& target : out->results())
          if (option != out && isSameFile(target, value))
            throw Error("--out", target,
                        "is what " + option->get_name() + " names: an input is not written over");
  }
}

}  // namespace fathom
