#pragma once

#include <vector>

#include "imaging/marker_blur.h"
#include "observables/clean_pair.h"
#include "panel/panel_map.h"

namespace fathom {

/// How much softer each marker's edges are in an image than in its rendering: of the panel that told the
/// pose, where enough of a marker is in view and some colour of it is not saturated. Entries of their own are
/// `posed.entry`, stamps since `time_zero`.
std::vector<MarkerBlur> markerEdges(const PosedImage& posed, const CleanPair& pair,
                                    const std::vector<PanelMap>& panels, const CameraSheet& sheet,
                                    Time time_zero);

}  // namespace fathom
