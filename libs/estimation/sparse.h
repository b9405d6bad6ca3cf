#pragma once

#include <Eigen/SparseCore>

/// Sparse matrices by their columns, rows in ascending order.
namespace fathom {

/// A^T B, on all cores; the same whatever their number.
Eigen::SparseMatrix<double> transposedTimes(const Eigen::SparseMatrix<double>& A,
                                            const Eigen::SparseMatrix<double>& B);

/// J with more columns, each held by a row of its own: what is estimated too, with a prior of so much sigma.
Eigen::SparseMatrix<double> withHeldColumns(const Eigen::SparseMatrix<double>& J,
                                            const Eigen::SparseMatrix<double>& C,
                                            const Eigen::VectorXd& sigma);

}  // namespace fathom
