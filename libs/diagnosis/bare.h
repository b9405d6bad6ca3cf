#pragma once

#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/through_poses.h"
#include "estimation/batch_state.h"

namespace fathom {

/// A fit's linear model as it would be without its effects, which are columns beside it.
struct Bare {
  Eigen::VectorXd residual;  ///< the effects taken out
  /// The effects are none of its unknowns.
  Eigen::SparseMatrix<double> J, taken;
  std::vector<UnknownBlock> blocks;
  std::vector<Eigen::Index> unknowns;   ///< which of the linearization's they are
  ThroughPoses through;                 ///< of these unknowns
  Eigen::SparseMatrix<double> columns;  ///< of the effects, over its rows, through the poses too
  Eigen::VectorXd values;               ///< as the fit found them
};

/// `linear`: at the state, which has the effects among its unknowns.
Bare bareOf(const Linearization& linear, const std::vector<Candidate>& effects, const BatchState& state);

/// The whole linearization so.
Linearization withoutEffects(Linearization linear, Bare bare);

}  // namespace fathom
