#pragma once

#include "diagnosis/result.h"

namespace fathom {

/// The verdict and its paragraph, from what was found and what remains unexplained of it. Where something
/// remains, effects found become the nearest ones, and the calibration is `known` again. `nominal`: the
/// nominal model.
void judge(Diagnosis& diagnosis, const Linearization& nominal, const EffectParameters<double>& known);

}  // namespace fathom
