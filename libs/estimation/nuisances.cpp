#include "estimation/nuisances.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"

namespace fathom {
namespace {

constexpr Eigen::Index kBlock = 32, kGramTile = 128;
constexpr Eigen::Index kAtOnce = 256;  // columns that are reduced each by itself

Eigen::Index tilesOf(Eigen::Index size) { return (size + kGramTile - 1) / kGramTile; }

/// U^T U, tile by tile: each is computed by one thread, so nothing depends on their number. Of columns that
/// have little in common most rows are zero in one or the other.
Eigen::MatrixXd gramOf(const Eigen::Ref<const Eigen::MatrixXd>& U) {
  const Eigen::Index tiles = tilesOf(U.cols()), strips = tilesOf(U.rows());
  const auto at = [](Eigen::Index tile) { return tile * kGramTile; };
  const auto size = [](Eigen::Index tile, Eigen::Index all) {
    return std::min(kGramTile, all - tile * kGramTile);
  };
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> is_there(strips, tiles);
  parallelFor(tiles, [&](Eigen::Index tile) {
    for (Eigen::Index k = 0; k < strips; ++k)
      is_there(k, tile) =
          (U.block(at(k), at(tile), size(k, U.rows()), size(tile, U.cols())).array() != 0).any();
  });
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(U.cols(), U.cols());
  parallelFor(tiles * tiles, [&](Eigen::Index tile) {
    const Eigen::Index i = tile / tiles, j = tile % tiles;
    if (j > i) return;
    auto own = gram.block(at(i), at(j), size(i, U.cols()), size(j, U.cols()));
    for (Eigen::Index k = 0, end = 0; k < strips; k = end + 1) {
      for (end = k; end < strips && is_there(end, i) && is_there(end, j);) ++end;
      if (end == k) continue;
      const Eigen::Index rows = std::min(at(end), U.rows()) - at(k);
      const Eigen::Ref<const Eigen::MatrixXd> left = U.block(at(k), at(i), rows, own.rows());
      own += i == j ? transposedTimesItself(left)
                    : transposedTimes(left, U.block(at(k), at(j), rows, own.cols()));
    }
  });
  return gram.selfadjointView<Eigen::Lower>();
}

}  // namespace

Nuisances::Nuisances(const Eigen::SparseMatrix<double>& J, const AtEnd& at_end)
    : at_end_(at_end), J_(J), full_(J.rightCols(at_end.full)), order_(J_.cols()) {
  order_.setIdentity();
  Eigen::SparseMatrix<double> sparse = J_.leftCols(J_.cols() - at_end.full);
  Eigen::SparseMatrix<double> product = transposedTimes(sparse, sparse);
  if (at_end.local > 0) {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
    Eigen::AMDOrdering<int>()(product, inverse);
    order_.indices().head(sparse.cols()) = inverse.inverse().eval().indices();
    sparse = (sparse * inverse).eval();
    product = (inverse.transpose() * product * inverse).eval();
  }
  transposed_ = sparse.transpose();
  factors_.compute(product);
  if (sparse.cols() > 0 && (factors_.info() != Eigen::Success || factors_.vectorD().minCoeff() <= 0))
    throw Singular("the nuisances' derivative lacks rank");
  across_.resize(sparse.cols(), full());
  eliminate(J_.rightCols(full()), across_);
  if (full() == 0) return;
  last_.compute(denseGramOf(full_) - gramOf(across_));
  if (!last_.succeeded()) throw Singular("the nuisances' derivative lacks rank");
}

void Nuisances::eliminate(const Eigen::SparseMatrix<double>& C, Eigen::MatrixXd& U) const {
  if (transposed_.rows() == 0) return;
  const Eigen::VectorXd root = factors_.vectorD().cwiseSqrt().cwiseInverse();
  parallelFor((C.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, C.cols() - first);
    Eigen::MatrixXd columns = transposed_ * C.middleCols(first, count);
    factors_.matrixL().solveInPlace(columns);
    U.block(0, first, columns.rows(), count) = root.asDiagonal() * columns;
  });
}

Eigen::MatrixXd Nuisances::forward(const Eigen::SparseMatrix<double>& C) const {
  Eigen::MatrixXd U(J_.cols(), C.cols());
  eliminate(C, U);
  if (full() == 0) return U;
  U.bottomRows(full()) = denseTransposedTimes(full_, C);
  parallelFor((U.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, U.cols() - first);
    auto own = U.bottomRows(full()).middleCols(first, count);
    own -= transposedTimes(across_, U.topRows(sparse()).middleCols(first, count));
    last_.halfSolveInPlace(own);
  });
  return U;
}

Eigen::MatrixXd Nuisances::solve(const Eigen::MatrixXd& b) const {
  const Eigen::VectorXd root = factors_.vectorD().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd x = order_ * b;
  auto first = x.topRows(sparse()), last = x.bottomRows(full());
  factors_.matrixL().solveInPlace(first);
  first = root.asDiagonal() * first;
  if (full() > 0) {
    last.noalias() -= across_.transpose() * first;
    last_.solveInPlace(last);
    first.noalias() -= across_ * last;
  }
  first = root.asDiagonal() * first;
  factors_.matrixU().solveInPlace(first);
  return order_.inverse() * x;
}

Reduced Nuisances::reduce(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r) const {
  return reduceOfLeft(C, project(r));
}

Reduced Nuisances::reduceOfLeft(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& left) const {
  Eigen::VectorXd norms(C.cols());
  for (Eigen::Index c = 0; c < norms.size(); ++c) norms[c] = C.col(c).norm();
  return {gram(C), C.transpose() * left, norms};
}

Eigen::MatrixXd Nuisances::gram(const Eigen::SparseMatrix<double>& C) const {
  return denseGramOf(C) - gramOf(forward(C));
}

std::vector<Reduced> Nuisances::reduceEach(const Eigen::SparseMatrix<double>& C, const Eigen::VectorXd& r,
                                           const std::vector<Eigen::Index>& sizes) const {
  const Eigen::VectorXd score = scores(C, r);
  std::vector<Reduced> each;
  Eigen::Index column = 0;
  for (std::size_t first = 0, behind = 0; first < sizes.size(); first = behind) {
    Eigen::Index width = 0;
    while (behind < sizes.size() && (width == 0 || width + sizes[behind] <= kAtOnce))
      width += sizes[behind++];
    const Eigen::MatrixXd U = forward(C.middleCols(column, width));
    for (Eigen::Index own = 0; first < behind; own += sizes[first++]) {
      const Eigen::SparseMatrix<double> C_own = C.middleCols(column + own, sizes[first]);
      Eigen::VectorXd norms(sizes[first]);
      for (Eigen::Index c = 0; c < norms.size(); ++c) norms[c] = C_own.col(c).norm();
      each.push_back({Eigen::MatrixXd(C_own.transpose() * C_own) - gramOf(U.middleCols(own, sizes[first])),
                      score.segment(column + own, sizes[first]), norms});
    }
    column += width;
  }
  return each;
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

Eigen::MatrixXd Nuisances::steps(const Eigen::SparseMatrix<double>& along) const {
  Eigen::MatrixXd steps(along.rows(), along.cols());
  parallelFor((along.cols() + kBlock - 1) / kBlock, [&](Eigen::Index block) {
    const Eigen::Index first = block * kBlock, count = std::min(kBlock, along.cols() - first);
    steps.middleCols(first, count) = -solve(along.middleCols(first, count));
  });
  return steps;
}

Eigen::VectorXd Nuisances::step(const Eigen::VectorXd& r) const { return -solve(J_.transpose() * r); }

}  // namespace fathom
