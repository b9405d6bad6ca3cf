#pragma once

#include <filesystem>

namespace fathom {

/// Copies a panel map with its mesh and the mesh's material files, so that it can be read in `folder` and
/// moved with it. Returns the map's copy. Throws Error, also where the mesh or its materials do not lie in
/// the map's folder or below.
std::filesystem::path copyPanelMap(const std::filesystem::path& map_file,
                                   const std::filesystem::path& folder);

}  // namespace fathom
