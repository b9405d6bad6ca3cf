#pragma once

#include <vector>

#include "audit/correction.h"
#include "core/time.h"
#include "sea_trial/sea_trial.h"

namespace fathom {

/// The tables as corrections make them, before anything is concluded: what a wrong unit or clock suggests of
/// axes and of other clocks is wrong, too. One that is about axes means those in which an import with the
/// corrections before it writes the readings. Clocks are corrected first. start: of the tables' seconds.
/// Throws std::invalid_argument as establishConventions().
SeaTrialData correctedTables(SeaTrialData data, const std::vector<Correction>& corrections, Time start);

}  // namespace fathom
