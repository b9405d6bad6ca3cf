#include "estimation/selected_inverse.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <stdexcept>

namespace fathom {

SelectedInverse::SelectedInverse(const Eigen::SparseMatrix<double>& lower) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factors(
      lower);
  if (factors.info() != Eigen::Success || (factors.vectorD().array() <= 0).any())
    throw std::runtime_error("a covariance is asked for that the readings do not determine");
  const Eigen::SparseMatrix<double> L = factors.matrixL().nestedExpression();
  inverse_ = L;  // the pattern; values are replaced from the last column on
  diagonal_ = factors.vectorD().cwiseInverse();

  // Z = D^-1 L^-1 + (1 - L^T) Z, a column at a time: Z_ij = -sum_k Z_ik L_kj over k in column j of L.
  const Eigen::Index n = L.cols();
  std::vector<Eigen::Index> place(static_cast<std::size_t>(n), -1);  // in column j
  Eigen::VectorXd sum(n);
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    const Eigen::Index begin = L.outerIndexPtr()[j], count = L.outerIndexPtr()[j + 1] - begin;
    const int* rows = L.innerIndexPtr() + begin;
    const double* values = L.valuePtr() + begin;
    for (Eigen::Index p = 0; p < count; ++p) place[static_cast<std::size_t>(rows[p])] = p;
    sum.head(count).setZero();
    for (Eigen::Index p = 0; p < count; ++p) {
      const int k = rows[p];
      sum[p] += diagonal_[k] * values[p];
      for (int q = inverse_.outerIndexPtr()[k]; q < inverse_.outerIndexPtr()[k + 1]; ++q) {
        const Eigen::Index at = place[static_cast<std::size_t>(inverse_.innerIndexPtr()[q])];
        if (at < 0) continue;
        sum[at] += inverse_.valuePtr()[q] * values[p];
        sum[p] += inverse_.valuePtr()[q] * values[at];
      }
    }
    for (Eigen::Index p = 0; p < count; ++p) {
      inverse_.valuePtr()[begin + p] = -sum[p];
      diagonal_[j] += values[p] * sum[p];
      place[static_cast<std::size_t>(rows[p])] = -1;
    }
  }
}

double SelectedInverse::operator()(Eigen::Index i, Eigen::Index j) const {
  if (i == j) return diagonal_[i];
  const Eigen::Index column = std::min(i, j), row = std::max(i, j);
  const int* begin = inverse_.innerIndexPtr() + inverse_.outerIndexPtr()[column];
  const int* end = inverse_.innerIndexPtr() + inverse_.outerIndexPtr()[column + 1];
  const int* found = std::lower_bound(begin, end, static_cast<int>(row));
  return found != end && *found == row ? inverse_.valuePtr()[found - inverse_.innerIndexPtr()] : 0.0;
}

Eigen::MatrixXd SelectedInverse::block(const std::vector<Eigen::Index>& indices) const {
  const auto n = std::ssize(indices);
  Eigen::MatrixXd result(n, n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b <= a; ++b)
      result(a, b) = result(b, a) =
          (*this)(indices[static_cast<std::size_t>(a)], indices[static_cast<std::size_t>(b)]);
  return result;
}

}  // namespace fathom
