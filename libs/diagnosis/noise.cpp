#include "diagnosis/noise.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "diagnosis/constants.h"

namespace fathom {

double partVariance(const RowInfo& row) {
  if (row.channel != kChannel<Pixels> || !(row.reflected > 0)) return 0;
  return (1 / std::max(kLeastSeen, row.seen_share) - 1) * std::pow(row.reflected * row.per_unit, 2);
}

HeldColumns budgetColumns(const Linearization& linear, const NoiseModel& noise) {
  HeldColumns held;
  std::vector<Eigen::Triplet<double>> entries;
  int width = 0;
  for (std::size_t k = 0; k < noise.budget.components.size(); ++k) {
    const Eigen::SparseMatrix<double> own = columnsOf(linear, noise.budget.components[k]);
    for (Eigen::Index c = 0; c < own.cols(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator e(own, c); e; ++e)
        entries.emplace_back(static_cast<int>(e.row()), width + static_cast<int>(c), e.value());
    width += static_cast<int>(own.cols());
    held.sizes.push_back(own.cols());
  }
  held.columns.resize(std::ssize(linear.rows), width);
  held.columns.setFromTriplets(entries.begin(), entries.end());
  return heldBy(std::move(held), noise);
}

HeldColumns heldBy(HeldColumns budget, const NoiseModel& noise) {
  budget.sigma.resize(budget.columns.cols());
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < budget.sizes.size(); first += budget.sizes[k++])
    budget.sigma.segment(first, budget.sizes[k]).setConstant(noise.sigmaOf(k));
  return budget;
}

NoiseModel NoiseModel::declared() const {
  NoiseModel declared = *this;
  declared.scales.clear();
  return declared;
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

}  // namespace fathom
