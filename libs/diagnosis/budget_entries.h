#pragma once

#include <vector>

#include "diagnosis/noise.h"
#include "diagnosis/result.h"

namespace fathom {

/// What the budget's components and the channels' noise turned out to be. `nominal`: at the nominal fit,
/// weighted.
std::vector<BudgetEntry> budgetOf(const NoiseModel& noise, const Linearization& nominal);

}  // namespace fathom
