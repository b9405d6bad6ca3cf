#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

namespace fathom {

/// Where an import goes: FOLDER/NAME.rawlog and its companions.
struct ImportTarget {
  std::filesystem::path folder;
  std::string name;

  std::filesystem::path file(const std::string& ending) const { return folder / (name + ending); }
};
/// --out and --name. `default_name`: what the name is where none is given, for --help.
void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name);

}  // namespace fathom
