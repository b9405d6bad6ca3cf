#pragma once

#include "diagnosis/result.h"

namespace fathom {

/// Shares, budget, posterior, the verdict and its paragraph, from what was found and what remains beside it.
/// `nominal`: the nominal model.
void judge(Diagnosis& diagnosis, const Linearization& nominal);

}  // namespace fathom
