#pragma once

#include <limits>
#include <vector>

#include "core/blocked_matrix.h"
#include "diagnosis/bare.h"
#include "diagnosis/evidence.h"
#include "diagnosis/noise.h"
#include "diagnosis/whitened_model.h"
#include "estimation/nuisances.h"

namespace fathom {

/// What is explained by the budget, then by the effects in what it leaves of them.
struct Split {
  double of_budget = 0;  ///< ln of its Bayes factor
  SizedSet effects;
  Eigen::VectorXd budget;  ///< its values, beside those of the effects; behind them those of shared unknowns
  Eigen::MatrixXd gram;    ///< of the effects, as the budget leaves them
  Eigen::VectorXd score;
};

/// The readings at a fit, reduced to what budget and effects can see of them: that takes long, and what a
/// hypothesis about sizes is worth follows from it quickly.
///
/// Most of a budget's columns are of one place on the panel each. They have readings in common with few
/// unknowns, as the water's, and with no pose: those unknowns, taken for columns that nothing holds, leave
/// the places with nothing in common, so that they are eliminated place by place.
class ReducedFit {
 public:
  /// `budget` has to outlive it.
  ReducedFit(const Linearization& linear, const std::vector<Candidate>& effects, const BatchState& state,
             const NoiseModel& noise, const HeldColumns& budget);

  const HeldColumns& budget() const { return budget_; }
  Eigen::Index unheld() const { return shared_.shared.cols(); }  ///< how many unknowns are columns
  /// Of the columns: the budget's, then those of shared unknowns (their sigma is kUnheld), then the effects'.
  const BlockedMatrix& gram() const { return gram_; }
  const Eigen::VectorXd& score() const { return score_; }
  static constexpr double kUnheld = std::numeric_limits<double>::infinity();

  /// `sigma`: of the columns, those of the effects are not looked at; `usual`: of the effects, which have so
  /// many columns each. Throws Singular where rounding is all that the readings tell.
  Split split(const Eigen::VectorXd& sigma, const Eigen::VectorXd& usual,
              const std::vector<Eigen::Index>& widths) const;
  /// ln of the readings' probability without effects, but for what all hypotheses have in common.
  double logEvidence(const Split& split) const;
  /// What is left of the readings by budget and effects of these values, all that is unknown being as well as
  /// it can: over the linearization's rows.
  Eigen::VectorXd leftBy(const Split& split) const;
  /// By how much the unknowns, of which the effects count as known, differ then from what the fit has them.
  Eigen::VectorXd stepBy(const Split& split) const;
  /// What the budget changes then, over the linearization's rows, with what follows through the poses.
  Eigen::VectorXd changeByBudget(const Split& split) const {
    return columns_.leftCols(budget_.sigma.size()) * split.budget.head(budget_.sigma.size());
  }
  Eigen::VectorXd whitened(const Eigen::VectorXd& rows) const { return W_ * rows; }

 private:
  struct Shared {
    Shared(const Bare& bare, const HeldColumns& budget);
    std::vector<Eigen::Index> local;                // of the budget: of one place each, and of no pose
    std::vector<Eigen::Index> of_light, of_others;  // places among the bare unknowns
    Eigen::SparseMatrix<double> shared, others;
  };

  Eigen::VectorXd change(const Split& split) const;

  Eigen::Index unknowns_;  // the effects too
  Bare bare_;
  const HeldColumns& budget_;
  Shared shared_;
  Eigen::SparseMatrix<double> columns_;  // through the poses too
  Whitener W_;
  Nuisances nuisances_;       // the other unknowns
  Eigen::VectorXd residual_;  // whitened
  Eigen::VectorXd left_;      // of that, by the nuisances
  BlockedMatrix gram_;
  Eigen::VectorXd score_;
};

}  // namespace fathom
