#include "diagnosis/through_poses.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "diagnosis/constants.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

/// Those of all unknowns that say where everything is.
std::vector<Eigen::Index> placesOf(const std::vector<UnknownBlock>& blocks) {
  std::vector<Eigen::Index> places;
  for (const UnknownBlock& block : blocks) {
    using enum UnknownBlock::Kind;
    if (block.kind == water || block.kind == flaws || block.kind == effect || block.kind == draw) continue;
    for (int k = 0; k < block.size; ++k) places.push_back(block.column + k);
  }
  return places;
}

}  // namespace

ThroughPoses::ThroughPoses(const Eigen::SparseMatrix<double>& J, const Eigen::SparseMatrix<double>& taken,
                           const std::vector<UnknownBlock>& blocks) {
  if (taken.nonZeros() == 0) return;
  const std::vector<Eigen::Index> places = placesOf(blocks);
  places_ = std::make_shared<Places>(columnsOf(J, places), columnsOf(taken, places));
}

Eigen::SparseMatrix<double> ThroughPoses::of(const Eigen::SparseMatrix<double>& columns) const {
  if (!places_) return columns;
  constexpr Eigen::Index kColumns = 32;  // at once: over all rows they are not sparse
  const Eigen::SparseMatrix<double> along = transposedTimes(places_->nuisances.J(), columns);
  std::vector<Eigen::SparseMatrix<double>> parts(
      static_cast<std::size_t>((columns.cols() + kColumns - 1) / kColumns));
  parallelFor(parts.size(), [&](std::size_t p) {
    const Eigen::Index first = static_cast<Eigen::Index>(p) * kColumns,
                       count = std::min(kColumns, columns.cols() - first);
    parts[p] = places_->of(columns.middleCols(first, count), along.middleCols(first, count));
  });
  return sideBySide(parts, columns.rows());
}

/// Only what other readings see moves a pose.
Eigen::SparseMatrix<double> ThroughPoses::Places::of(const Eigen::SparseMatrix<double>& columns,
                                                     const Eigen::SparseMatrix<double>& along) const {
  if (along.nonZeros() == 0) return columns;
  const Eigen::MatrixXd light = taken * nuisances.steps(along);
  Eigen::SparseMatrix<double> all(columns.rows(), columns.cols());
  all.reserve(columns.nonZeros());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const double least = kLeastThrough * columns.col(c).squaredNorm();
    const bool follows = light.col(c).squaredNorm() > least;
    const double least_each = least / static_cast<double>(light.rows());
    all.startVec(c);
    Eigen::SparseMatrix<double>::InnerIterator own(columns, c);
    for (Eigen::Index i = 0; i < light.rows(); ++i) {
      const bool is_own = own && own.row() == i;
      double value = follows && light(i, c) * light(i, c) > least_each ? light(i, c) : 0;
      if (is_own) {
        value += own.value();
        ++own;
      }
      if (is_own || value != 0) all.insertBack(i, c) = value;
    }
  }
  all.finalize();
  return all;
}

Eigen::VectorXd ThroughPoses::transposed(const Eigen::VectorXd& v) const {
  if (!places_) return v;
  const Eigen::MatrixXd moved = places_->taken.transpose() * v;
  return v + places_->nuisances.J() * places_->nuisances.steps(moved.sparseView());
}

}  // namespace fathom
