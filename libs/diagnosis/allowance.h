#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/whitened_model.h"

/// What an effect may be for a part of a recording without being missed by the model: as much as what the
/// error budget makes of it when it lasts. What the budget holds is the same all the time, so most of it
/// cancels between a part and the rest, and the least that comes and goes would be told; but 0.03 % of the
/// light for some seconds is no mismatch where 1 % is allowed for good.
namespace fathom {

/// Whether it is on for a part, and can last.
bool comesAndGoes(const Candidate& candidate);
/// Itself, always on.
Candidate lasting(Candidate candidate);

/// Covariance of the values that an effect which lasts would have to have to look like the budget's own: of
/// columns C and B, W-whitened, (C^T C + prior)^-1 C^T B scatter. All else is as it is: where poses that are
/// estimated too hide most of an effect, that makes the budget no larger.
Eigen::MatrixXd allowanceOf(const Eigen::SparseMatrix<double>& columns,
                            const Eigen::SparseMatrix<double>& budget, const Eigen::VectorXd& scatter,
                            const Eigen::VectorXd& prior_sigma);
/// Of each of these, which last.
std::vector<Eigen::MatrixXd> allowancesOf(const WhitenedModel& model, const std::vector<Candidate>& lasting);

/// T, of information G and what is allowed A: readings of which so much is no news have information T G and
/// score T times the score, T = (I + G A)^-1.
Eigen::MatrixXd newsOf(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& allowed);

}  // namespace fathom
