#pragma once

#include <filesystem>

/// What ships with the program.
namespace fathom::test {

inline const std::filesystem::path kSource = FATHOM_SOURCE_DIR;
inline const std::filesystem::path kConfig = kSource / "config";
inline const std::filesystem::path kDexrovMap = kSource / "maps/dexrov/panel.yaml";
inline const std::filesystem::path kRov = kConfig / "rov.yaml";

}  // namespace fathom::test
