#pragma once

#include <string>

#include "panel/panel_map.h"

namespace fathom {

/// The same panel printed with another family's markers: places, turns and the size of the border square
/// stay, so that families are compared at equal printed size. Ids are spread over the family, those left out
/// that look like another one, and the print is the plain one; a panel that has nothing but this family keeps
/// its own. Throws Error("families", …): the family has too few ids, or its pattern reaches beyond the border
/// square and over the plate's edge or another marker.
PanelMap withFamily(PanelMap map, const std::string& family);

}  // namespace fathom
