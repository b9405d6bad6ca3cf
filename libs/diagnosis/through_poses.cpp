#include "diagnosis/through_poses.h"

#include <algorithm>
#include <vector>

#include "diagnosis/constants.h"

namespace fathom {
namespace {

/// Those of all unknowns that say where everything is.
Eigen::SparseMatrix<double> selectPlaces(const std::vector<UnknownBlock>& blocks, Eigen::Index unknowns) {
  std::vector<Eigen::Triplet<double>> ones;
  int count = 0;
  for (const UnknownBlock& block : blocks) {
    using enum UnknownBlock::Kind;
    if (block.kind == water || block.kind == flaws || block.kind == effect || block.kind == draw) continue;
    for (int k = 0; k < block.size; ++k) ones.emplace_back(block.column + k, count++, 1.0);
  }
  Eigen::SparseMatrix<double> select(unknowns, count);
  select.setFromTriplets(ones.begin(), ones.end());
  return select;
}

}  // namespace

ThroughPoses::ThroughPoses(const Eigen::SparseMatrix<double>& J, const Eigen::SparseMatrix<double>& taken,
                           const std::vector<UnknownBlock>& blocks) {
  if (taken.nonZeros() == 0) return;
  const Eigen::SparseMatrix<double> select = selectPlaces(blocks, J.cols());
  places_ = std::make_shared<Places>(J * select, taken * select);
}

Eigen::SparseMatrix<double> ThroughPoses::of(const Eigen::SparseMatrix<double>& columns) const {
  if (!places_) return columns;
  // Only what other readings see moves a pose.
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Eigen::Index> seen;
  const Eigen::SparseMatrix<double> along = (places_->nuisances.J().transpose() * columns).pruned();
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    if (along.col(c).nonZeros() > 0) seen.push_back(c);
  if (seen.empty()) return columns;
  Eigen::SparseMatrix<double> select(columns.cols(), std::ssize(seen));
  for (Eigen::Index k = 0; k < std::ssize(seen); ++k) select.insert(seen[static_cast<std::size_t>(k)], k) = 1;
  const Eigen::MatrixXd light = places_->taken * places_->nuisances.steps(along * select);
  for (Eigen::Index k = 0; k < light.cols(); ++k) {
    const Eigen::Index c = seen[static_cast<std::size_t>(k)];
    if (light.col(k).squaredNorm() < kLeastThrough * columns.col(c).squaredNorm()) continue;
    for (Eigen::Index i = 0; i < light.rows(); ++i)
      if (light(i, k) != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(c), light(i, k));
  }
  Eigen::SparseMatrix<double> added(columns.rows(), columns.cols());
  added.setFromTriplets(entries.begin(), entries.end());
  return columns + added;
}

Eigen::VectorXd ThroughPoses::transposed(const Eigen::VectorXd& v) const {
  if (!places_) return v;
  const Eigen::MatrixXd moved = places_->taken.transpose() * v;
  return v + places_->nuisances.J() * places_->nuisances.steps(moved.sparseView());
}

}  // namespace fathom
