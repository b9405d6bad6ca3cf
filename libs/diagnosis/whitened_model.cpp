#include "diagnosis/whitened_model.h"

#include <algorithm>
#include <cmath>

#include "estimation/sparse.h"

namespace fathom {
namespace {

Linearization weighted(Linearization linear) {
  applyRobustWeights(linear);
  return linear;
}

}  // namespace

WhitenedModel::WhitenedModel(Linearization linear, const NoiseModel& noise)
    : WhitenedModel(Weighted{}, weighted(std::move(linear)), noise) {}

WhitenedModel::WhitenedModel(Weighted, Linearization linear, const NoiseModel& noise)
    : WhitenedModel(std::make_shared<Linearization>(std::move(linear)), noise) {}

WhitenedModel::WhitenedModel(const std::shared_ptr<const Linearization>& linear, const NoiseModel& noise)
    : WhitenedModel(linear, noise, budgetColumns(*linear, noise)) {}

WhitenedModel::WhitenedModel(Weighted, Linearization linear, const NoiseModel& noise,
                             const HeldColumns& budget)
    : WhitenedModel(std::make_shared<Linearization>(std::move(linear)), noise, budget) {}

WhitenedModel::WhitenedModel(const std::shared_ptr<const Linearization>& linear, const NoiseModel& noise,
                             const HeldColumns& budget)
    : WhitenedModel(linear, noise, Followed(*linear, budget)) {}

WhitenedModel::Followed::Followed(const Linearization& linear, HeldColumns all)
    : through(linear.J, linear.taken, linear.blocks), budget(std::move(all)) {
  budget.columns = through.of(budget.columns);
}

WhitenedModel::WhitenedModel(std::shared_ptr<const Linearization> linear, const NoiseModel& noise,
                             Followed followed)
    : linear_(std::move(linear)),
      noise_(noise),
      followed_{std::move(followed.through), heldBy(std::move(followed.budget), noise)},
      W_(*linear_, noise),
      nuisances_(nuisancesOf()) {
  residual_ = Eigen::VectorXd::Zero(nuisances_.J().rows());
  residual_.head(linear_->residual.size()) = W_ * linear_->residual;
}

WhitenedModel WhitenedModel::under(const NoiseModel& noise) const {
  const bool has_its_columns = noise.budget == noise_.budget && noise.apart == noise_.apart;
  return has_its_columns ? WhitenedModel(linear_, noise, followed_) : WhitenedModel(linear_, noise);
}

Whitener::Whitener(const Linearization& linear, const NoiseModel& noise)
    : diagonal_(std::ssize(linear.rows)), below_(diagonal_.size(), diagonal_.size()) {
  // A row's sigma was taken too large by so much, for what its neighbours have in common with it.
  Eigen::VectorXd size = Eigen::VectorXd::Ones(std::ssize(linear.rows));
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const ChannelNoise& channel = noise.of(linear.rows[i].channel);
    const double parts = noise.parts * noise.parts * partVariance(linear.rows[i]);
    size[static_cast<Eigen::Index>(i)] = channel.independentScale() / channel.scale / std::sqrt(1 + parts);
  }
  diagonal_ = size;
  for (const Channel channel : kEveryChannel) {
    const double correlation = noise.of(channel).correlation;
    if (correlation == 0) continue;
    const double fresh = 1 / std::sqrt(1 - correlation * correlation);
    for (const auto& [a, b] : neighbours(linear, channel)) {
      const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b);
      entries.emplace_back(static_cast<int>(j), static_cast<int>(i), -correlation * fresh * size[i]);
      diagonal_[j] *= fresh;
    }
  }
  below_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::SparseMatrix<double> Whitener::operator*(const Eigen::SparseMatrix<double>& columns) const {
  Eigen::SparseMatrix<double> own = diagonal_.asDiagonal() * columns;
  if (below_.nonZeros() > 0) own += below_ * columns;
  return own;
}

Eigen::VectorXd Whitener::operator*(const Eigen::VectorXd& column) const {
  return diagonal_.cwiseProduct(column) + below_ * column;
}

Eigen::VectorXd Whitener::transposed(const Eigen::VectorXd& v) const {
  return diagonal_.cwiseProduct(v) + below_.transpose() * v;
}

Nuisances WhitenedModel::nuisancesOf() const {
  const HeldColumns held = localFirst(followed_.budget, noise_.budget);
  return {withHeldColumns(W_ * linear_->J, W_ * held.columns, held.sigma),
          {held.local, held.sigma.size() - held.local}};
}

Eigen::SparseMatrix<double> WhitenedModel::whitenedOf(const Eigen::SparseMatrix<double>& followed) const {
  Eigen::SparseMatrix<double> all = W_ * followed;
  all.conservativeResize(residual_.size(), followed.cols());
  return all;
}

Eigen::SparseMatrix<double> WhitenedModel::whitened(const Eigen::SparseMatrix<double>& columns) const {
  return whitenedOf(followed_.through.of(columns));
}

HeldColumns WhitenedModel::whitenedBudget() const {
  HeldColumns budget = followed_.budget;
  budget.columns = whitenedOf(followed_.budget.columns);
  return budget;
}

Eigen::VectorXd WhitenedModel::scoreShares() const {
  return followed_.through.transposed(
      W_.transposed(nuisances_.project(residual_).col(0).head(linear_->residual.size())));
}

Reduced WhitenedModel::reduce(const std::vector<Candidate>& candidates) const {
  return reduce(columnsOf(*linear_, candidates));
}

std::vector<Reduced> WhitenedModel::reduceEach(const std::vector<Candidate>& candidates) const {
  std::vector<Eigen::Index> sizes;
  for (const Candidate& candidate : candidates)
    sizes.push_back(std::ssize(columnsOf(*linear_, candidate.effect)));
  return nuisances_.reduceEach(whitened(columnsOf(*linear_, candidates)), residual_, sizes);
}

double WhitenedModel::costOf(const Eigen::VectorXd& left) const {
  double cost = 0;
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    // Huber's loss of a reading whose weight on its square s is w = a / sqrt(s): 2 a sqrt(s) - a^2 = w s (2 -
    // w).
    const RowInfo* row =
        i < std::ssize(linear_->rows) ? &linear_->rows[static_cast<std::size_t>(i)] : nullptr;
    const double w = row != nullptr && row->channel != kChannel<Prior> ? row->robust_weight : 1;
    cost += 0.5 * (2 - w) * left[i] * left[i];
  }
  return cost;
}

}  // namespace fathom
