#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/error_budget.h"
#include "estimation/linearization.h"

namespace fathom {

/// Whose value one is, among those of its component: a marker's, a place's in a colour, an image's, …
using Owner = std::pair<int, std::ptrdiff_t>;

/// Columns over a linearization's rows of what is estimated too, each with the sigma that holds it.
struct HeldColumns {
  Eigen::SparseMatrix<double> columns;
  Eigen::VectorXd sigma;
  /// Of each component's share of them, in the components' order; behind them come those of owners that are
  /// apart (NoiseModel::apart).
  std::vector<Eigen::Index> sizes;
  std::vector<Owner> owners;            ///< of all of them
  std::vector<Eigen::Index> of_places;  ///< those of one place each
  std::vector<std::size_t> of_apart;    ///< the components of those behind
  Eigen::Index local = 0;               ///< so many, the first, have readings of one image or place each
};
/// The same with those of one image or place each before the others; `sizes` are of no use then.
HeldColumns localFirst(const HeldColumns& held, const ErrorBudget& budget);

/// Whether each value is of readings of one place.
bool isOfOnePlace(VarianceComponent::Each each);

/// Columns of a component, and whose they are.
struct OwnedColumns {
  Eigen::SparseMatrix<double> columns;
  std::vector<Owner> owners;
};

/// The unit of values of what acts (VarianceComponent::by): an effect's parameter's, or a reading's; "1" of
/// shares. Empty where none is laid down. Throws std::invalid_argument where it names none.
std::string unitOf(const std::string& by);

/// What a component of the budget can do to a linearization's readings: columns over its rows, of values that
/// are independent of each other, each of sigma VarianceComponent::sigma (in its unit). No column where no
/// reading shows it. Throws std::invalid_argument where an effect, parameter, channel or covariate that it
/// names is none.
OwnedColumns columnsOf(const Linearization& linear, const VarianceComponent& component);

/// Where on the panel an owner is: "marker 583", "0.31 m, -0.22 m of the panel"; empty where it is not on it.
std::string whereIs(const Owner& owner, VarianceComponent::Each each, const Linearization& linear);

}  // namespace fathom
