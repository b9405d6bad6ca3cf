#pragma once

#include <Eigen/SparseCore>
#include <vector>

/// Sparse matrices by their columns, rows in ascending order.
namespace fathom {

/// A^T B, on all cores; the same whatever their number.
Eigen::SparseMatrix<double> transposedTimes(const Eigen::SparseMatrix<double>& A,
                                            const Eigen::SparseMatrix<double>& B);

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// The same as a dense matrix: where most columns of A have readings in common with most of B, by far faster.
Eigen::MatrixXd denseTransposedTimes(const SparseRows& A, const Eigen::SparseMatrix<double>& B);

/// A^T A so.
Eigen::MatrixXd denseGramOf(const SparseRows& A);

/// Columns of b behind those of a.
Eigen::SparseMatrix<double> sideBySide(const Eigen::SparseMatrix<double>& a,
                                       const Eigen::SparseMatrix<double>& b);

/// Columns of each behind those of the ones before; so many rows have all of them.
Eigen::SparseMatrix<double> sideBySide(const std::vector<Eigen::SparseMatrix<double>>& parts,
                                       Eigen::Index rows);

/// These columns, in this order.
Eigen::SparseMatrix<double> columnsOf(const Eigen::SparseMatrix<double>& A,
                                      const std::vector<Eigen::Index>& columns);

/// These rows, which ascend.
Eigen::SparseMatrix<double> rowsOf(const Eigen::SparseMatrix<double>& A,
                                   const std::vector<Eigen::Index>& rows);

/// J with more columns, each held by a row of its own: what is estimated too, with a prior of so much sigma.
Eigen::SparseMatrix<double> withHeldColumns(const Eigen::SparseMatrix<double>& J,
                                            const Eigen::SparseMatrix<double>& C,
                                            const Eigen::VectorXd& sigma);

}  // namespace fathom
