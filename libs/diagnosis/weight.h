#pragma once

#include <map>
#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/noise.h"
#include "estimation/batch_state.h"

namespace fathom {

/// What a hypothesis is worth at a fit of it: Laplace's approximation of ln p(readings | effects, budget),
/// but for what all hypotheses about the same readings have in common.
struct Weight {
  double log_evidence = 0;
  /// ln of the effects' Bayes factor against none of them, all else being as it is at this fit: what they
  /// gain to first order. What a fit without them lies behind by more, it lies in another minimum.
  double log_bayes_factor = 0;
  std::vector<EstimatedScale> scales;  ///< of the budget's components, the likeliest beside these effects
  std::vector<std::map<Owner, double>> apart;  ///< see NoiseModel
  /// Of the effects' columns one behind the other (columnsOf()), held as they are declared: how far sizes are
  /// from nothing, all else from the state.
  Evidence effects;
  /// The same of the sizes that they were weighed with.
  Eigen::VectorXd values;
  /// By how much the unknowns but the effects differ from what the fit has them, the effects being `values`
  /// and the budget what is likeliest beside them.
  Eigen::VectorXd step;
  /// What is left of the readings then, the budget not being taken off: over the linearization's rows.
  Eigen::VectorXd left;
  /// What the budget makes of the light of each row, as PatchLight has it; 0 of other rows.
  Eigen::VectorXd reflected, level, moved;
};

/// `linear`: at the state, with the effects among its unknowns, weighted (applyRobustWeights()); `budget`:
/// its columns there. They are weighted otherwise by then: what effects and budget explain is no outlier. The
/// budget's components are marginalized over their values at the likeliest scales, the effects over theirs
/// with the priors of EffectEvidence, everything else with flat ones. Throws Singular where readings weigh so
/// much that rounding is all that is left of them.
Weight weigh(Linearization& linear, HeldColumns& budget, const std::vector<Candidate>& effects,
             const BatchState& state, const NoiseModel& assumed);

}  // namespace fathom
