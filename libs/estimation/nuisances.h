#pragma once

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "core/linear_algebra.h"
#include "estimation/sparse.h"

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
  /// Columns in an order that eliminates with little fill. At their end so many that have few readings in
  /// common with others, whose places among them are looked for; and so many that have with most, and are
  /// eliminated last, without looking for zeros.
  struct AtEnd {
    Eigen::Index local = 0, full = 0;
  };
  /// Throws Singular where J lacks rank.
  Nuisances(const Eigen::SparseMatrix<double>& J, const AtEnd& at_end);
  explicit Nuisances(const Eigen::SparseMatrix<double>& J) : Nuisances(J, AtEnd{}) {}

  const Eigen::SparseMatrix<double>& J() const { return J_; }
  const AtEnd& atEnd() const { return at_end_; }
  Reduced reduce(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r) const;
  /// The first of these alone.
  Eigen::MatrixXd gram(const Eigen::SparseMatrix<double>& C) const;
  /// The same where `left` is P r.
  Reduced reduceOfLeft(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& left) const;
  /// The same of blocks of so many columns, each by itself: what they take grows with the largest only.
  std::vector<Reduced> reduceEach(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r,
                                  const std::vector<Eigen::Index>& sizes) const;
  /// C^T P R.
  Eigen::MatrixXd scores(const Eigen::SparseMatrix<double>& C, const Eigen::MatrixXd& R) const;
  /// P R.
  Eigen::MatrixXd project(const Eigen::MatrixXd& R) const;
  /// Covariance of these unknowns.
  Eigen::MatrixXd covariance(const std::vector<Eigen::Index>& unknowns) const;
  /// The unknowns' least-squares step: -(J^T J)^-1 J^T r.
  Eigen::VectorXd step(const Eigen::VectorXd& r) const;
  /// The same of several, of which J^T r is given.
  Eigen::MatrixXd steps(const Eigen::SparseMatrix<double>& along) const;

 private:
  /// U with U^T U = C^T J (J^T J)^-1 J^T C: what C has in common with J, eliminated.
  Eigen::MatrixXd forward(const Eigen::SparseMatrix<double>& C) const;
  /// The same of the sparse ones alone, in the first rows of U.
  void eliminate(const Eigen::SparseMatrix<double>& C, Eigen::MatrixXd& U) const;
  /// (J^T J)^-1 b.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  Eigen::Index full() const { return at_end_.full; }
  Eigen::Index sparse() const { return J_.cols() - full(); }

  AtEnd at_end_;
  Eigen::SparseMatrix<double> J_;
  SparseRows full_;                                                      // its full columns
  Eigen::SparseMatrix<double> transposed_;                               // the others, as rows
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;  // in which they are eliminated
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors_;
  Eigen::MatrixXd across_;  // the full columns' share of J^T J with the others, eliminated
  PositiveFactors last_;    // of what that leaves of their own
};

}  // namespace fathom
