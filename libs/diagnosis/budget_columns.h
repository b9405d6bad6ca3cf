#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "diagnosis/error_budget.h"
#include "estimation/linearization.h"

namespace fathom {

/// Columns over a linearization's rows of what is estimated too, each with the sigma that holds it.
struct HeldColumns {
  Eigen::SparseMatrix<double> columns;
  Eigen::VectorXd sigma;
  std::vector<Eigen::Index> sizes;  ///< of each component's share of them
  Eigen::Index local = 0;           ///< so many, the first, have readings of one image each
};
/// The same with those of one image each before the others; `sizes` are of no use then.
HeldColumns localFirst(const HeldColumns& held, const ErrorBudget& budget);

/// What a component of the budget can do to a linearization's readings: columns over its rows, of values that
/// are independent of each other, each of sigma VarianceComponent::sigma (in its unit). No column where no
/// reading shows it. Throws std::invalid_argument where an effect, parameter, channel or covariate that it
/// names is none.
Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const VarianceComponent& component);

}  // namespace fathom
