#pragma once

#include <vector>

#include "diagnosis/error_budget.h"
#include "diagnosis/evidence.h"

namespace fathom {

/// The error budget of one vehicle, from what its quiet recordings show: in each, the budget's components had
/// the scales `recordings[i][k]`, estimated under `before` (NoiseModel::scales).
///
/// Hierarchical and normal in ln sigma (Gelman et al., Bayesian Data Analysis, ch. 5): half of the variance
/// that `before` declares is taken to be between vehicles, half between recordings of one. So a component
/// that no recording tells anything of stays as declared, and none is ever known better than recordings
/// differ. The order is that of before.components. Throws std::invalid_argument where a recording has another
/// number.
ErrorBudget learntBudget(const ErrorBudget& before,
                         const std::vector<std::vector<EstimatedScale>>& recordings);

}  // namespace fathom
