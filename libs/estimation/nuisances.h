#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

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
  /// Columns in an order that eliminates with little fill. Throws std::runtime_error where J lacks rank.
  explicit Nuisances(const Eigen::SparseMatrix<double>& J);

  const Eigen::SparseMatrix<double>& J() const { return J_; }
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
  /// The same, with `along` J^T C.
  Eigen::MatrixXd scores(const Eigen::SparseMatrix<double>& C, const Eigen::SparseMatrix<double>& along,
                         const Eigen::MatrixXd& R) const;
  /// D^-1/2 L^-1 B, columns side by side.
  Eigen::MatrixXd forward(const Eigen::SparseMatrix<double>& B) const;

  Eigen::SparseMatrix<double> J_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors_;
};

}  // namespace fathom
