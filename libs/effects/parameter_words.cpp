#include "effects/parameter_words.h"

#include <algorithm>
#include <array>

#include "effects/image_regions.h"
#include "effects/sensor_kinds.h"

namespace fathom {

std::span<const std::string_view> wordsOf(ParameterKind kind) {
  static constexpr auto kRegionNames = [] {
    std::array<std::string_view, kImageRegions.size()> names;
    std::transform(kImageRegions.begin(), kImageRegions.end(), names.begin(),
                   [](const ImageRegion& region) { return region.name; });
    return names;
  }();
  if (kind == ParameterKind::sensor) return kSensorKinds;
  if (kind == ParameterKind::region) return kRegionNames;
  return {};
}

}  // namespace fathom
