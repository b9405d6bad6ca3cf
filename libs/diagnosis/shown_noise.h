#pragma once

#include <cstdint>

#include "diagnosis/noise.h"

namespace fathom {

/// The noise that an estimate's residuals show once every effect of the catalogue may explain its share: what
/// is left out of the model is not taken for noise. Scale and correlation are those with which simulated
/// noise leaves the residuals seen, so what the estimate follows is accounted for. `linear`: weighted (see
/// applyRobustWeights()), at an estimate with the noise `assumed`; robust weights of light are taken anew, so
/// that what an effect explains is no outlier.
NoiseModel shownNoise(Linearization linear, const NoiseModel& assumed, std::uint64_t seed);

}  // namespace fathom
