#pragma once

#include <string>
#include <vector>

#include "environment/fitted_water.h"
#include "observables/patches.h"

namespace fathom {

/// One line for each channel whose attenuation or veil the patches' distances do not determine, with the
/// reason and with the distances that would, found by adding as many patches, white and black, farther away
/// or nearer, to the fit's information.
std::vector<std::string> rangeWarnings(const std::vector<Patch>& patches, const WaterFit& fit);

}  // namespace fathom
