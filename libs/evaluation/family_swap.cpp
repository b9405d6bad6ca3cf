#include "evaluation/family_swap.h"

#include <algorithm>

#include "core/error.h"
#include "panel/face.h"
#include "panel/marker_family.h"

namespace fathom {
namespace {

/// Gives marker i the first id from the i-th of as many equal shares of the family on, which looks like no
/// marker before it.
void giveIds(std::vector<Marker>& markers, const std::string& family) {
  const auto count = static_cast<std::size_t>(markerCount(family));
  for (std::size_t i = 0; i < markers.size(); ++i) {
    markers[i].family = family;
    markers[i].look = {};
    const auto isTaken = [&](int id) {
      markers[i].id = id;
      return std::any_of(markers.begin(), markers.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const Marker& other) { return lookAlike(markers[i], other); });
    };
    const std::size_t first = (2 * i + 1) * count / (2 * markers.size());
    std::size_t tried = 0;
    while (tried < count && isTaken(static_cast<int>((first + tried) % count))) ++tried;
    if (tried == count)
      throw Error("families", family,
                  "has too few markers, " + std::to_string(count) + ", for the panel's " +
                      std::to_string(markers.size()));
  }
}

void checkPlaces(const PanelMap& map) {
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const auto pattern = patternCorners_panel(map.markers[i]);
    const auto fail = [&](const std::string& why) {
      return Error("families", map.markers[i].family,
                   "does not fit on panel " + map.name + ": at the place of marker " + std::to_string(i + 1) +
                       " its pattern " + why);
    };
    for (const Vector3d& corner : pattern)
      if (!faceHeight_m(map.body, corner)) throw fail("reaches beyond the face");
    for (std::size_t j = 0; j < i; ++j)
      if (overlap(pattern, patternCorners_panel(map.markers[j]))) throw fail("overlaps another marker");
  }
}

}  // namespace

PanelMap withFamily(PanelMap map, const std::string& family) {
  const bool has_it_already = std::all_of(map.markers.begin(), map.markers.end(),
                                          [&](const Marker& marker) { return marker.family == family; });
  if (has_it_already) return map;
  giveIds(map.markers, family);
  checkPlaces(map);
  return map;
}

}  // namespace fathom
