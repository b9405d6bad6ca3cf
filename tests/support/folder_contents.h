#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/files.h"

namespace fathom::test {

/// The bytes of all files below a folder, by their path in it.
inline std::map<std::string, std::string> contentsOf(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder)] = readTextFile(entry.path());
  return files;
}

/// Their names alone, for messages that can be read.
inline std::string namesIn(const std::map<std::string, std::string>& files) {
  std::string names;
  for (const auto& [name, bytes] : files) names += name + " (" + std::to_string(bytes.size()) + "), ";
  return names;
}

}  // namespace fathom::test
