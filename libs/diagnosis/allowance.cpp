#include "diagnosis/allowance.h"

#include <Eigen/LU>

#include "core/linear_algebra.h"

namespace fathom {

bool comesAndGoes(const Candidate& candidate) {
  return !candidate.isForGood() && !candidate.time_s && !candidate.peak;
}

Candidate lasting(Candidate candidate) {
  candidate.active_s = {};
  return candidate;
}

Eigen::MatrixXd allowanceOf(const Eigen::SparseMatrix<double>& columns,
                            const Eigen::SparseMatrix<double>& budget, const Eigen::VectorXd& scatter,
                            const Eigen::VectorXd& prior_sigma) {
  Eigen::MatrixXd information = columns.transpose() * columns;
  information.diagonal() += prior_sigma.array().square().inverse().matrix();
  const Eigen::MatrixXd common = columns.transpose() * budget;
  const Eigen::MatrixXd alike = inverseOf(information) * common * scatter.asDiagonal();
  return alike * alike.transpose();
}

std::vector<Eigen::MatrixXd> allowancesOf(const WhitenedModel& model, const std::vector<Candidate>& lasting) {
  const HeldColumns budget = heldBy(model.whitenedBudget(), model.noise().declared());
  std::vector<Eigen::MatrixXd> all;
  for (const Candidate& candidate : lasting)
    all.push_back(allowanceOf(model.whitened(columnsOf(model.linear(), {candidate})), budget.columns,
                              budget.sigma, priorSigmas(model.linear(), {candidate})));
  return all;
}

Eigen::MatrixXd newsOf(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& allowed) {
  return (Eigen::MatrixXd::Identity(gram.rows(), gram.cols()) + gram * allowed).partialPivLu().inverse();
}

}  // namespace fathom
