#pragma once

#include <vector>

#include "diagnosis/candidate.h"
#include "estimation/batch_state.h"

namespace fathom {

/// A fit's linear model as it would be without its effects, which are columns beside it.
struct Bare {
  Linearization linear;  ///< the effects are none of its unknowns, and taken out of its residual
  Eigen::SparseMatrix<double> columns;  ///< of the effects, over its rows
  Eigen::VectorXd values;               ///< as the fit found them
};

/// `linear`: at the state, which has the effects among its unknowns.
Bare withoutEffects(const Linearization& linear, const std::vector<Candidate>& effects,
                    const BatchState& state);

}  // namespace fathom
