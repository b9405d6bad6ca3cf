#include "estimation/nuisances.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

constexpr Eigen::Index kBlock = 32, kGramTile = 128;

/// U^T U, tile by tile: each is computed by one thread, so nothing depends on their number.
Eigen::MatrixXd gramOf(const Eigen::MatrixXd& U) {
  const Eigen::Index tiles = (U.cols() + kGramTile - 1) / kGramTile;
  Eigen::MatrixXd gram(U.cols(), U.cols());
  const auto width = [&](Eigen::Index tile) { return std::min(kGramTile, U.cols() - tile * kGramTile); };
  parallelFor(tiles * tiles, [&](Eigen::Index k) {
    const Eigen::Index i = k / tiles, j = k % tiles;
    if (j > i) return;
    const auto own = U.middleCols(i * kGramTile, width(i));
    gram.block(i * kGramTile, j * kGramTile, width(i), width(j)) =
        i == j ? transposedTimesItself(own) : transposedTimes(own, U.middleCols(j * kGramTile, width(j)));
  });
  return gram.selfadjointView<Eigen::Lower>();
}

}  // namespace

Nuisances::Nuisances(const Eigen::SparseMatrix<double>& J, Eigen::Index full)
    : J_(J), sparse_(J.leftCols(J.cols() - full)), full_(J.rightCols(full)) {
  factors_.compute(transposedTimes(sparse_, sparse_));
  if (sparse_.cols() > 0 && (factors_.info() != Eigen::Success || factors_.vectorD().minCoeff() <= 0))
    throw Singular("the nuisances' derivative lacks rank");
  across_ = eliminated(denseTransposedTimes(sparse_, full_));
  if (full == 0) return;
  last_.compute(denseTransposedTimes(full_, full_) - gramOf(across_));
  if (!last_.succeeded()) throw Singular("the nuisances' derivative lacks rank");
}

Eigen::MatrixXd Nuisances::eliminated(Eigen::MatrixXd U) const {
  if (U.rows() == 0) return U;
  const Eigen::VectorXd root = factors_.vectorD().cwiseSqrt().cwiseInverse();
  parallelFor((U.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    auto columns = U.middleCols(block * kBlock, std::min(kBlock, U.cols() - block * kBlock));
    factors_.matrixL().solveInPlace(columns);
    columns = root.asDiagonal() * columns;
  });
  return U;
}

Eigen::MatrixXd Nuisances::forward(const Eigen::SparseMatrix<double>& C) const {
  if (full() == 0) return eliminated(transposedTimes(sparse_, C));
  Eigen::MatrixXd U(J_.cols(), C.cols());
  U.topRows(sparse_.cols()) = eliminated(transposedTimes(sparse_, C));
  U.bottomRows(full()) = denseTransposedTimes(full_, C);
  parallelFor((U.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, U.cols() - first);
    auto own = U.bottomRows(full()).middleCols(first, count);
    own -= transposedTimes(across_, U.topRows(sparse_.cols()).middleCols(first, count));
    last_.halfSolveInPlace(own);
  });
  return U;
}

Eigen::MatrixXd Nuisances::solve(const Eigen::MatrixXd& b) const {
  if (full() == 0) return factors_.solve(b);
  const Eigen::Index sparse = J_.cols() - full();
  const Eigen::VectorXd root = factors_.vectorD().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd x = b;
  auto first = x.topRows(sparse), last = x.bottomRows(full());
  factors_.matrixL().solveInPlace(first);
  first = root.asDiagonal() * first;
  last.noalias() -= across_.transpose() * first;
  last_.solveInPlace(last);
  first.noalias() -= across_ * last;
  first = root.asDiagonal() * first;
  factors_.matrixU().solveInPlace(first);
  return x;
}

Reduced Nuisances::reduce(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r,
                          const std::vector<Eigen::Index>& blocks) const {
  const Eigen::MatrixXd U = forward(C);
  Reduced reduced;
  reduced.norms = Eigen::VectorXd(C.cols());
  for (Eigen::Index c = 0; c < C.cols(); ++c) reduced.norms[c] = C.col(c).norm();
  reduced.score = scores(C, r);
  if (blocks.empty()) {
    reduced.gram = Eigen::MatrixXd(C.transpose() * C) - gramOf(U);
    return reduced;
  }
  reduced.gram = Eigen::MatrixXd::Zero(C.cols(), C.cols());
  std::vector<Eigen::Index> first(blocks.size(), 0);
  std::partial_sum(blocks.begin(), blocks.end() - 1, first.begin() + 1);
  parallelFor(blocks.size(), [&](std::size_t b) {
    const Eigen::SparseMatrix<double> own = C.middleCols(first[b], blocks[b]);
    const auto U_own = U.middleCols(first[b], blocks[b]);
    reduced.gram.block(first[b], first[b], blocks[b], blocks[b]) =
        Eigen::MatrixXd(own.transpose() * own) - U_own.transpose() * U_own;
  });
  return reduced;
}

Eigen::MatrixXd Nuisances::scores(const Eigen::SparseMatrix<double>& C, const Eigen::MatrixXd& R) const {
  return C.transpose() * project(R);
}

Eigen::MatrixXd Nuisances::project(const Eigen::MatrixXd& R) const {
  Eigen::MatrixXd left(R.rows(), R.cols());
  parallelFor((R.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, R.cols() - first);
    const Eigen::MatrixXd along = J_.transpose() * R.middleCols(first, count);
    left.middleCols(first, count) = R.middleCols(first, count) - J_ * solve(along);
  });
  return left;
}

Eigen::MatrixXd Nuisances::covariance(const std::vector<Eigen::Index>& unknowns) const {
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(J_.cols(), std::ssize(unknowns));
  for (std::size_t k = 0; k < unknowns.size(); ++k) unit(unknowns[k], static_cast<Eigen::Index>(k)) = 1;
  return solve(unit)(unknowns, Eigen::all);
}

Eigen::VectorXd Nuisances::step(const Eigen::VectorXd& r) const { return -solve(J_.transpose() * r); }

}  // namespace fathom
