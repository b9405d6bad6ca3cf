#pragma once

#include "diagnosis/saturated.h"
#include "diagnosis/scatter.h"

namespace fathom {

/// What the markers' places scatter by beyond their own uncertainty. Panels bend more than prints stretch.
MarkerScatter markerScatter(const Saturated& saturated, const Linearization& linear);

/// What the places' albedos and edges scatter by beyond what their readings' noise would have them.
/// `saturated`: without any such scatter. `parts` is left.
PrintScatter printScatter(const Saturated& saturated, const Linearization& linear);

/// What places differ by in parts, from how much more they scatter the less of them is seen. `saturated`:
/// with the scatter of all of them.
double partScatter(const Saturated& saturated, const Linearization& linear);

}  // namespace fathom
