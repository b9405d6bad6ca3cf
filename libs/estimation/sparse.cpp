#include "estimation/sparse.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace fathom {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Appends a column's entries to the last one that was begun.
void append(const Matrix& from, Eigen::Index column, Eigen::Index at, Matrix& to) {
  for (Matrix::InnerIterator entry(from, column); entry; ++entry)
    to.insertBack(entry.row(), at) = entry.value();
}

}  // namespace

Matrix transposedTimes(const Matrix& A, const Matrix& B) {
  constexpr Eigen::Index kColumns = 64;  // at once
  const Matrix transposed = A.transpose();
  std::vector<Matrix> parts(static_cast<std::size_t>((B.cols() + kColumns - 1) / kColumns));
  parallelFor(parts.size(), [&](std::size_t p) {
    const Eigen::Index first = static_cast<Eigen::Index>(p) * kColumns;
    parts[p] = transposed * B.middleCols(first, std::min(kColumns, B.cols() - first));
    parts[p].data().squeeze();  // Eigen reserves as much as A has, for each
  });
  return sideBySide(parts, A.cols());
}

Matrix withHeldColumns(const Matrix& J, const Matrix& C, const Eigen::VectorXd& sigma) {
  Matrix all(J.rows() + C.cols(), J.cols() + C.cols());
  all.reserve(J.nonZeros() + C.nonZeros() + C.cols());
  for (Eigen::Index c = 0; c < J.cols(); ++c) {
    all.startVec(c);
    append(J, c, c, all);
  }
  for (Eigen::Index c = 0; c < C.cols(); ++c) {
    const Eigen::Index column = J.cols() + c;
    all.startVec(column);
    append(C, c, column, all);
    all.insertBack(J.rows() + c, column) = 1 / sigma[c];
  }
  all.finalize();
  return all;
}

/// Row by row: a row's entries of both, each with each. Tiles of B's columns side by side, so that nothing
/// depends on the number of threads.
Eigen::MatrixXd denseTransposedTimes(const SparseRows& A, const Eigen::SparseMatrix<double>& B) {
  constexpr Eigen::Index kTile = 64;
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(A.cols(), B.cols());
  parallelFor((B.cols() + kTile - 1) / kTile, [&](Eigen::Index tile) {
    const Eigen::Index first = tile * kTile, count = std::min(kTile, B.cols() - first);
    const SparseRows own = B.middleCols(first, count);
    for (Eigen::Index row = 0; row < own.rows(); ++row)
      for (SparseRows::InnerIterator b(own, row); b; ++b)
        for (SparseRows::InnerIterator a(A, row); a; ++a)
          product(a.col(), first + b.col()) += a.value() * b.value();
  });
  return product;
}

/// The same, of the lower half: a row's entries of the tile with each that is not before them.
Eigen::MatrixXd denseGramOf(const SparseRows& A) {
  constexpr Eigen::Index kTile = 64;
  const int *first_of = A.outerIndexPtr(), *column = A.innerIndexPtr();
  const double* value = A.valuePtr();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(A.cols(), A.cols());
  parallelFor((A.cols() + kTile - 1) / kTile, [&](Eigen::Index tile) {
    const auto first = static_cast<int>(tile * kTile), behind = static_cast<int>((tile + 1) * kTile);
    for (Eigen::Index row = 0; row < A.rows(); ++row) {
      const int end = first_of[row + 1];
      for (auto b = static_cast<int>(std::lower_bound(column + first_of[row], column + end, first) - column);
           b < end && column[b] < behind; ++b)
        for (int a = b; a < end; ++a) gram(column[a], column[b]) += value[a] * value[b];
    }
  });
  return gram.selfadjointView<Eigen::Lower>();
}

Matrix sideBySide(const Matrix& a, const Matrix& b) { return sideBySide({a, b}, a.rows()); }

Matrix sideBySide(const std::vector<Matrix>& parts, Eigen::Index rows) {
  Eigen::Index entries = 0, columns = 0;
  for (const Matrix& part : parts) {
    entries += part.nonZeros();
    columns += part.cols();
  }
  Matrix all(rows, columns);
  all.reserve(entries);
  Eigen::Index column = 0;
  for (const Matrix& part : parts)
    for (Eigen::Index c = 0; c < part.cols(); ++c, ++column) {
      all.startVec(column);
      append(part, c, column, all);
    }
  all.finalize();
  return all;
}

Matrix columnsOf(const Matrix& A, const std::vector<Eigen::Index>& columns) {
  Eigen::Index entries = 0;
  for (const Eigen::Index c : columns) entries += A.col(c).nonZeros();
  Matrix own(A.rows(), std::ssize(columns));
  own.reserve(entries);
  for (Eigen::Index c = 0; c < own.cols(); ++c) {
    own.startVec(c);
    append(A, columns[static_cast<std::size_t>(c)], c, own);
  }
  own.finalize();
  return own;
}

Matrix rowsOf(const Matrix& A, const std::vector<Eigen::Index>& rows) {
  std::vector<Eigen::Index> place(static_cast<std::size_t>(A.rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k)
    place[static_cast<std::size_t>(rows[k])] = static_cast<Eigen::Index>(k);
  Matrix own(std::ssize(rows), A.cols());
  own.reserve(A.nonZeros());
  for (Eigen::Index c = 0; c < A.cols(); ++c) {
    own.startVec(c);
    for (Matrix::InnerIterator entry(A, c); entry; ++entry)
      if (const Eigen::Index row = place[static_cast<std::size_t>(entry.row())]; row >= 0)
        own.insertBack(row, c) = entry.value();
  }
  own.finalize();
  own.data().squeeze();
  return own;
}

}  // namespace fathom
