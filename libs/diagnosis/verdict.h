#pragma once

#include "diagnosis/result.h"

namespace fathom {

/// Odds against what ln of the odds are for.
double oddsAgainst(double log_odds);

/// Shares, budget, posterior, the verdict and its paragraph, from what was found and what remains beside it.
/// `nominal`: the nominal model.
void judge(Diagnosis& diagnosis, const Linearization& nominal);

}  // namespace fathom
