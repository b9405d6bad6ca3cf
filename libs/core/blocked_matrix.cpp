#include "core/blocked_matrix.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numeric>
#include <utility>

namespace fathom {
namespace {

/// L^-1.
Eigen::MatrixXd inverseOfHalf(const Eigen::MatrixXd& L) {
  Eigen::MatrixXd half = Eigen::MatrixXd::Identity(L.rows(), L.cols());
  L.triangularView<Eigen::Lower>().solveInPlace(half);
  return half;
}

}  // namespace

BlockedMatrix::BlockedMatrix(Eigen::MatrixXd all)
    : border(static_cast<std::size_t>(all.rows())), across(0, all.cols()), within(std::move(all)) {
  std::iota(border.begin(), border.end(), Eigen::Index{0});
}

Eigen::MatrixXd BlockedMatrix::lastColumns(Eigen::Index count) const {
  Eigen::MatrixXd all(size(), count);
  Eigen::Index row = 0;
  for (const std::vector<Eigen::Index>& own : members)
    for (const Eigen::Index k : own) all.row(k) = across.row(row++).tail(count);
  all(border, Eigen::all) = within.rightCols(count);
  return all;
}

BlockedFactors::BlockedFactors(const BlockedMatrix& A, const Eigen::VectorXd& sigma)
    : border_(A.border), units_(sigma) {
  Eigen::VectorXd held = Eigen::VectorXd::Ones(sigma.size());
  for (Eigen::Index k = 0; k < std::ssize(border_); ++k) {
    const Eigen::Index i = border_[static_cast<std::size_t>(k)];
    if (std::isfinite(sigma[i])) continue;
    held[i] = 0;
    units_[i] = 1 / std::sqrt(A.within(k, k));
  }
  for (std::size_t b = 0; b < A.blocks.size() && succeeded_; ++b) {
    const Eigen::VectorXd unit = units_(A.members[b]);
    Eigen::MatrixXd block = unit.asDiagonal() * A.blocks[b] * unit.asDiagonal();
    block.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> llt(block);
    L_.push_back(llt.matrixLLT());
    succeeded_ = llt.info() == Eigen::Success && L_.back().diagonal().allFinite();
    inner_.insert(inner_.end(), A.members[b].begin(), A.members[b].end());
  }
  if (!succeeded_) return;
  const Eigen::VectorXd unit = units_(border_);
  across_ = units_(inner_).asDiagonal() * A.across * unit.asDiagonal();
  solveBlocks(across_, false);
  Eigen::MatrixXd rest = unit.asDiagonal() * A.within * unit.asDiagonal();
  rest.diagonal() += held(border_);
  if (!inner_.empty()) rest -= transposedTimesItself(across_);
  last_.compute(std::move(rest));
  succeeded_ = last_.succeeded();
}

void BlockedFactors::solveBlocks(Eigen::MatrixXd& x, bool transposed) const {
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& L : L_) {
    auto own = x.middleRows(first, L.rows());
    if (transposed)
      L.triangularView<Eigen::Lower>().transpose().solveInPlace(own);
    else
      L.triangularView<Eigen::Lower>().solveInPlace(own);
    first += L.rows();
  }
}

double BlockedFactors::logDeterminant() const {
  double sum = last_.logDeterminant();
  for (const Eigen::MatrixXd& L : L_) sum += 2 * L.diagonal().array().log().sum();
  return sum;
}

Eigen::MatrixXd BlockedFactors::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd inner = b(inner_, Eigen::all), last = b(border_, Eigen::all);
  solveBlocks(inner, false);
  if (!inner_.empty()) last -= transposedTimes(across_, inner);
  last_.solveInPlace(last);
  inner.noalias() -= across_ * last;
  solveBlocks(inner, true);
  Eigen::MatrixXd x(b.rows(), b.cols());
  x(inner_, Eigen::all) = inner;
  x(border_, Eigen::all) = last;
  return x;
}

Eigen::MatrixXd BlockedFactors::beyondBlocks() const {
  Eigen::MatrixXd G = across_;
  solveBlocks(G, true);
  G.transposeInPlace();
  last_.halfSolveInPlace(G);
  return G;
}

Eigen::VectorXd BlockedFactors::inverseDiagonal() const {
  Eigen::VectorXd diagonal(units_.size());
  diagonal(border_) = last_.inverseDiagonal();
  Eigen::VectorXd inner = beyondBlocks().colwise().squaredNorm();
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& L : L_) {
    inner.segment(first, L.rows()) += inverseOfHalf(L).colwise().squaredNorm().transpose();
    first += L.rows();
  }
  diagonal(inner_) = inner;
  return diagonal;
}

Eigen::MatrixXd BlockedFactors::inverse() const {
  Eigen::MatrixXd all(units_.size(), units_.size());
  const Eigen::MatrixXd last = last_.inverse(), G = beyondBlocks();
  all(border_, border_) = last;
  if (inner_.empty()) return all;
  Eigen::MatrixXd inner = transposedTimesItself(G);
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& L : L_) {
    const Eigen::MatrixXd half = inverseOfHalf(L);
    inner.block(first, first, L.rows(), L.rows()) += half.transpose() * half;
    first += L.rows();
  }
  all(inner_, inner_) = inner;
  Eigen::MatrixXd Z = across_;
  solveBlocks(Z, true);
  const Eigen::MatrixXd between = -transposedTimes(Z.transpose().eval(), last);
  all(inner_, border_) = between;
  all(border_, inner_) = between.transpose();
  return all;
}

}  // namespace fathom
