#pragma once

#include <filesystem>

namespace fathom {

/// Where copyPanelMap() puts the map itself. Throws Error where the map or a mesh's material library cannot
/// be read.
std::filesystem::path copyOfPanelMap(const std::filesystem::path& map_file,
                                     const std::filesystem::path& folder);

/// Copies a map (panel_maps.h: a panel's, or a list of panels with all of theirs) with meshes and their
/// material files, so that it can be read in `folder` and moved with it. Files keep their places relative to
/// each other: in `folder` is what is in the deepest folder that holds them all. Returns the map's copy.
/// Throws Error, also where a file is named by an absolute path.
std::filesystem::path copyPanelMap(const std::filesystem::path& map_file,
                                   const std::filesystem::path& folder);

}  // namespace fathom
