#include "estimation/nuisances.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "core/parallel.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

constexpr Eigen::Index kBlock = 32;

/// U^T U, tile by tile: each is computed by one thread, so nothing depends on their number.
Eigen::MatrixXd gramOf(const Eigen::MatrixXd& U) {
  const Eigen::Index tiles = (U.cols() + kBlock - 1) / kBlock;
  Eigen::MatrixXd gram(U.cols(), U.cols());
  const auto width = [&](Eigen::Index tile) { return std::min(kBlock, U.cols() - tile * kBlock); };
  parallelFor(tiles * tiles, [&](Eigen::Index k) {
    const Eigen::Index i = k / tiles, j = k % tiles;
    if (j > i) return;
    gram.block(i * kBlock, j * kBlock, width(i), width(j)).noalias() =
        U.middleCols(i * kBlock, width(i)).transpose() * U.middleCols(j * kBlock, width(j));
  });
  return gram.selfadjointView<Eigen::Lower>();
}

}  // namespace

Nuisances::Nuisances(const Eigen::SparseMatrix<double>& J) : J_(J) {
  factors_.compute(transposedTimes(J_, J_));
  if (factors_.info() != Eigen::Success || factors_.vectorD().minCoeff() <= 0)
    throw std::runtime_error("the nuisances' derivative lacks rank");
}

Eigen::MatrixXd Nuisances::forward(const Eigen::SparseMatrix<double>& B) const {
  Eigen::MatrixXd U = B;
  const Eigen::VectorXd root = factors_.vectorD().cwiseSqrt().cwiseInverse();
  parallelFor((U.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    auto columns = U.middleCols(block * kBlock, std::min(kBlock, U.cols() - block * kBlock));
    factors_.matrixL().solveInPlace(columns);
    columns = root.asDiagonal() * columns;
  });
  return U;
}

Reduced Nuisances::reduce(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r,
                          const std::vector<Eigen::Index>& blocks) const {
  const Eigen::SparseMatrix<double> along = transposedTimes(J_, C);
  const Eigen::MatrixXd U = forward(along);
  Reduced reduced;
  reduced.norms = Eigen::VectorXd(C.cols());
  for (Eigen::Index c = 0; c < C.cols(); ++c) reduced.norms[c] = C.col(c).norm();
  reduced.score = scores(C, along, r);
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
  return scores(C, transposedTimes(J_, C), R);
}

Eigen::MatrixXd Nuisances::scores(const Eigen::SparseMatrix<double>& C,
                                  const Eigen::SparseMatrix<double>& along, const Eigen::MatrixXd& R) const {
  Eigen::MatrixXd scores(C.cols(), R.cols());
  parallelFor((R.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, R.cols() - first);
    const auto own = R.middleCols(first, count);
    const Eigen::MatrixXd left = J_.transpose() * own;
    scores.middleCols(first, count) = C.transpose() * own - along.transpose() * factors_.solve(left);
  });
  return scores;
}

Eigen::MatrixXd Nuisances::project(const Eigen::MatrixXd& R) const {
  Eigen::MatrixXd left(R.rows(), R.cols());
  parallelFor((R.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, R.cols() - first);
    const Eigen::MatrixXd along = J_.transpose() * R.middleCols(first, count);
    left.middleCols(first, count) = R.middleCols(first, count) - J_ * factors_.solve(along);
  });
  return left;
}

Eigen::MatrixXd Nuisances::covariance(const std::vector<Eigen::Index>& unknowns) const {
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(J_.cols(), std::ssize(unknowns));
  for (std::size_t k = 0; k < unknowns.size(); ++k) unit(unknowns[k], static_cast<Eigen::Index>(k)) = 1;
  return factors_.solve(unit)(unknowns, Eigen::all);
}

Eigen::VectorXd Nuisances::step(const Eigen::VectorXd& r) const {
  return -factors_.solve(J_.transpose() * r);
}

}  // namespace fathom
