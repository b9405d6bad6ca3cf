#pragma once

#include <filesystem>
#include <vector>

#include "panel/panel_map.h"

/// Several panels in one place. A map file is either one panel's (panel_map.h) or a list of such files,
/// relative to itself:
///
///     panels: [left/panel.yaml, right/panel.yaml]
namespace fathom {

/// The panels' own files, in the list's order; of a panel's map, itself. Throws Error: damaged, another key
/// besides `panels`, no panel in the list.
std::vector<std::filesystem::path> panelMapFiles(const std::filesystem::path& file);

/// All panels of a map file; one where it is a panel's own. Throws Error as readPanelMap() does, and where
/// two panels have the same name, markers of the same family and id or of the same looks,
/// or another marker_look each: images are searched for one.
std::vector<PanelMap> readPanelMaps(const std::filesystem::path& file);

}  // namespace fathom
