#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace fathom {

/// Those entries of a sparse symmetric matrix's inverse that lie in the pattern of its Cholesky factor, by
/// the recursion of Takahashi, Fagan & Chin 1973 (see Erisman & Tinney 1975): of a covariance, the blocks of
/// all unknowns that share a row, at the cost of one more factorization.
class SelectedInverse {
 public:
  /// Lower triangle of a positive definite matrix whose order eliminates with little fill: it is kept.
  /// Throws std::runtime_error where it is not positive definite.
  explicit SelectedInverse(const Eigen::SparseMatrix<double>& lower);

  /// Zero for a pair that nothing joins, not even by way of others that come before both.
  double operator()(Eigen::Index i, Eigen::Index j) const;
  Eigen::MatrixXd block(const std::vector<Eigen::Index>& indices) const;

 private:
  Eigen::SparseMatrix<double> inverse_;  ///< strictly lower
  Eigen::VectorXd diagonal_;
};

}  // namespace fathom
