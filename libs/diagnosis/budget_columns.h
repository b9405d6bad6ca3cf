#pragma once

#include <Eigen/SparseCore>

#include "diagnosis/error_budget.h"
#include "estimation/linearization.h"

namespace fathom {

/// What a component of the budget can do to a linearization's readings: columns over its rows, of values that
/// are independent of each other, each of sigma VarianceComponent::sigma (in its unit). No column where no
/// reading shows it. Throws std::invalid_argument where an effect, parameter, channel or covariate that it
/// names is none.
Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const VarianceComponent& component);

}  // namespace fathom
