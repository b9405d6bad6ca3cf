#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "core/linear_algebra.h"

namespace fathom {

/// Candidates as the nuisances leave them: with P = I - J (J^T J)^-1 J^T,
struct Reduced {
  Eigen::MatrixXd gram;   ///< C^T P C, information
  Eigen::VectorXd score;  ///< C^T P r
  Eigen::VectorXd norms;  ///< |C| of each column as it was
};

/// What is estimated in any case, factorized once: everything tested is tested with it projected off.
class Nuisances {
 public:
  /// Columns in an order that eliminates with little fill; the last `full` of them have readings in common
  /// with most others, and are eliminated last, without looking for zeros. Throws Singular where J lacks
  /// rank.
  explicit Nuisances(const Eigen::SparseMatrix<double>& J, Eigen::Index full = 0);

  const Eigen::SparseMatrix<double>& J() const { return J_; }
  Eigen::Index full() const { return across_.cols(); }
  /// `blocks`: sizes of the gram's diagonal blocks that are wanted, everything else is zero; none: all of it.
  Reduced reduce(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r,
                 const std::vector<Eigen::Index>& blocks = {}) const;
  /// C^T P R.
  Eigen::MatrixXd scores(const Eigen::SparseMatrix<double>& C, const Eigen::MatrixXd& R) const;
  /// P R.
  Eigen::MatrixXd project(const Eigen::MatrixXd& R) const;
  /// Covariance of these unknowns.
  Eigen::MatrixXd covariance(const std::vector<Eigen::Index>& unknowns) const;
  /// The unknowns' least-squares step: -(J^T J)^-1 J^T r.
  Eigen::VectorXd step(const Eigen::VectorXd& r) const;

 private:
  /// U with U^T U = C^T J (J^T J)^-1 J^T C: what C has in common with J, eliminated.
  Eigen::MatrixXd forward(const Eigen::SparseMatrix<double>& C) const;
  /// The same of columns J^T C of the sparse ones alone.
  Eigen::MatrixXd eliminated(Eigen::MatrixXd U) const;
  /// (J^T J)^-1 b.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  Eigen::SparseMatrix<double> J_, sparse_, full_;  // all columns, the first, the last
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors_;
  Eigen::MatrixXd across_;  // the full columns' share of J^T J with the others, eliminated
  PositiveFactors last_;    // of what that leaves of their own
};

}  // namespace fathom
