#include "diagnosis/noise.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/parallel.h"
#include "diagnosis/constants.h"

namespace fathom {

double partVariance(const RowInfo& row) {
  if (row.channel != kChannel<Pixels> || !(row.reflected > 0)) return 0;
  return (1 / std::max(kLeastSeen, row.seen_share) - 1) * std::pow(row.reflected * row.per_unit, 2);
}

HeldColumns budgetColumns(const Linearization& linear, const NoiseModel& noise) {
  struct Column {
    const Eigen::SparseMatrix<double>* from;
    Eigen::Index column;
    Owner owner;
  };
  const std::size_t count = noise.budget.components.size();
  std::vector<OwnedColumns> components(count);
  parallelFor(count, [&](std::size_t k) { components[k] = columnsOf(linear, noise.budget.components[k]); });
  std::vector<Column> columns, behind;
  HeldColumns held;
  for (std::size_t k = 0; k < count; ++k) {
    const OwnedColumns& own = components[k];
    const auto before = std::ssize(columns);
    for (Eigen::Index c = 0; c < own.columns.cols(); ++c) {
      const Owner& owner = own.owners[static_cast<std::size_t>(c)];
      const bool is_apart = noise.sigmaApart(k, owner).has_value();
      (is_apart ? behind : columns).push_back({&own.columns, c, owner});
      if (is_apart) held.of_apart.push_back(k);
    }
    held.sizes.push_back(std::ssize(columns) - before);
    if (isOfOnePlace(noise.budget.components[k].each))
      for (Eigen::Index c = before; c < std::ssize(columns); ++c) held.of_places.push_back(c);
  }
  columns.insert(columns.end(), behind.begin(), behind.end());
  held.columns.resize(std::ssize(linear.rows), std::ssize(columns));
  for (const Column& one : columns) {
    held.columns.startVec(std::ssize(held.owners));
    for (Eigen::SparseMatrix<double>::InnerIterator e(*one.from, one.column); e; ++e)
      held.columns.insertBack(e.row(), std::ssize(held.owners)) = e.value();
    held.owners.push_back(one.owner);
  }
  held.columns.finalize();
  return heldBy(std::move(held), noise);
}

HeldColumns heldBy(HeldColumns budget, const NoiseModel& noise) {
  budget.sigma.resize(budget.columns.cols());
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < budget.sizes.size(); first += budget.sizes[k++])
    budget.sigma.segment(first, budget.sizes[k]).setConstant(noise.sigmaOf(k));
  for (const std::size_t k : budget.of_apart) {
    budget.sigma[first] =
        noise.sigmaApart(k, budget.owners[static_cast<std::size_t>(first)]).value_or(noise.sigmaOf(k));
    ++first;
  }
  return budget;
}

std::optional<double> NoiseModel::sigmaApart(std::size_t component, const Owner& owner) const {
  if (apart.empty()) return {};
  const auto found = apart[component].find(owner);
  return found == apart[component].end() ? std::nullopt : std::optional(found->second);
}

NoiseModel NoiseModel::with(const ErrorBudget& other) const {
  NoiseModel noise = *this;
  noise.budget = other;
  noise.scales = declaredScales(other);
  if (apart.empty()) return noise;
  noise.apart.assign(other.components.size(), {});
  for (std::size_t k = 0; k < apart.size(); ++k)
    for (std::size_t i = 0; i < other.components.size(); ++i)
      if (other.components[i].name == budget.components[k].name) noise.apart[i] = apart[k];
  return noise;
}

NoiseModel NoiseModel::declared() const {
  NoiseModel declared = *this;
  declared.scales = declaredScales(budget);
  return declared;
}

/// Of `other`'s components, those that are as shown here as they are here; none where all are as declared.
std::vector<EstimatedScale> NoiseModel::declaredScales(const ErrorBudget& other) const {
  std::vector<EstimatedScale> all;
  bool any = false;
  for (const VarianceComponent& component : other.components) {
    all.push_back({component.sigma, component.logSd()});
    for (std::size_t k = 0; k < scales.size(); ++k)
      if (budget.components[k].is_as_shown && budget.components[k].name == component.name) {
        all.back() = scales[k];
        any = true;
      }
  }
  if (!any) all.clear();
  return all;
}

double ChannelNoise::independentScale() const {
  return scale * std::sqrt((1 + correlation) / (1 - correlation));
}

void NoiseModel::applyTo(ProblemOptions& options) const {
  for (std::size_t c = 0; c < channels.size(); ++c) options.noise_scale[c] = channels[c].independentScale();
  options.light_scatter = light_scatter;
}

std::vector<std::array<std::size_t, 2>> neighbours(const Linearization& linear, Channel channel) {
  std::vector<std::array<std::size_t, 2>> pairs;
  for (const auto& track : linear.tracks) {
    if (track.size() < 2 || linear.rows[track[0]].channel != channel) continue;
    std::vector<double> spacings;
    for (std::size_t k = 1; k < track.size(); ++k)
      spacings.push_back(linear.rows[track[k]].t_s - linear.rows[track[k - 1]].t_s);
    const double longest_s = 1.5 * upperMedian(spacings);
    for (std::size_t k = 1; k < track.size(); ++k)
      if (spacings[k - 1] <= longest_s) pairs.push_back({track[k - 1], track[k]});
  }
  return pairs;
}

double cameraNoise(const NoiseModel& noise) {
  double product = 1;
  for (const Channel channel : {kChannel<Markers>, kChannel<EpipolarResidual>, kChannel<Pixels>})
    product *= noise.of(channel).independentScale();
  return product;
}

bool isQuieter(const NoiseModel& shown, const NoiseModel& before) {
  for (std::size_t c = 0; c < before.channels.size(); ++c)
    if (shown.channels[c].independentScale() < kLessNoise * before.channels[c].independentScale())
      return true;
  return shown.light_scatter < kLessNoise * before.light_scatter || shown.parts < kLessNoise * before.parts;
}

}  // namespace fathom
