#include "diagnosis/budget_entries.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/median.h"
#include "core/text.h"
#include "diagnosis/constants.h"
#include "diagnosis/covariate.h"

namespace fathom {
namespace {

/// Of so many readings of one sigma, were it not more than `largest`.
double beyondOf(const ChannelNoise& noise, double largest) {
  const double ratio = noise.scale / largest;
  return ratio > 1 ? static_cast<double>(noise.rows) * (0.5 * (ratio * ratio - 1) - std::log(ratio)) : 0;
}

/// Who is apart: where, and by how much that counts.
void addApart(BudgetEntry& entry, const VarianceComponent& component, const std::map<Owner, double>& apart,
              const Linearization& nominal) {
  for (const auto& [owner, sigma] : apart) {
    const double ratio = std::max(1.0, sigma / (component.sigma * component.factor));
    entry.beyond += 0.5 * (ratio * ratio - 1) - std::log(ratio);
    entry.largest_apart = std::max(entry.largest_apart, sigma);
    const std::string where = whereIs(owner, component.each, nominal);
    if (!where.empty() && std::find(entry.apart.begin(), entry.apart.end(), where) == entry.apart.end())
      entry.apart.push_back(where);
  }
}

/// Where a channel's readings scatter most beside the others: "image y 380 to 470 px"; empty where it is the
/// same everywhere.
std::string noisiestPart(const Linearization& linear, Channel channel) {
  std::string where;
  double most = kNoisierPart;
  for (const Covariate& covariate : covariatesOf(linear, channel)) {
    const std::vector<double> limits = binLimits(linear, channel, covariate);
    if (limits.size() < 3) continue;
    std::vector<double> square(limits.size() - 1), rows(limits.size() - 1);
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].channel == channel)
        if (const auto bin = binOf(limits, covariate.of(linear.rows[i]))) {
          // In full: what a robust fit makes light of is noise all the same.
          square[*bin] +=
              std::pow(linear.residual[static_cast<Eigen::Index>(i)], 2) / linear.rows[i].robust_weight;
          ++rows[*bin];
        }
    const double all = std::accumulate(square.begin(), square.end(), 0.0),
                 count = std::accumulate(rows.begin(), rows.end(), 0.0);
    for (std::size_t bin = 0; bin < rows.size(); ++bin) {
      const double ratio = (square[bin] / rows[bin]) / ((all - square[bin]) / (count - rows[bin]));
      const double log_likelihood = 0.5 * rows[bin] * (ratio - 1 - std::log(ratio));
      if (!(ratio > 1 && log_likelihood > most)) continue;
      most = log_likelihood;
      where = print("%s %.3g to %.3g", covariate.name.c_str(), limits[bin] * covariate.scale,
                    limits[bin + 1] * covariate.scale) +
              (covariate.unit == "1" ? "" : " " + covariate.unit);
    }
  }
  return where;
}

/// Says so where more of a channel's readings than is ordinary are far beyond what the others scatter by.
void noteOutliers(BudgetEntry& entry, const Linearization& nominal, Channel channel, double ordinary) {
  std::vector<double> sizes;  // in full: what a robust fit makes light of is an outlier all the same
  for (std::size_t i = 0; i < nominal.rows.size(); ++i)
    if (nominal.rows[i].channel == channel)
      sizes.push_back(std::abs(nominal.residual[static_cast<Eigen::Index>(i)]) /
                      std::sqrt(nominal.rows[i].robust_weight));
  if (sizes.empty()) return;
  const double others = sigmaByMedian(sizes);
  const auto beyond =
      std::count_if(sizes.begin(), sizes.end(), [&](double size) { return size > kOutlierSigmas * others; });
  const double share = static_cast<double>(beyond) / static_cast<double>(sizes.size());
  if (share <= ordinary) return;
  entry.outlier_share = share;
  entry.others = entry.estimate * others;
}

BudgetEntry entryOf(Channel channel, const NoiseModel& all, const Linearization& nominal) {
  const ChannelNoise& noise = all.of(channel);
  BudgetEntry entry;
  entry.component = "noise of " + nameOf(channel);
  entry.unit = "of the sigma stated";
  entry.source = "data sheet";
  entry.prior = 1;
  entry.estimate = entry.largest_apart = noise.scale;
  entry.log_sd = 1 / std::sqrt(2 * static_cast<double>(noise.rows));
  entry.beyond = beyondOf(noise, all.budget.noise_factor);
  if (entry.beyond <= kBursts) return entry;
  if (const std::string where = noisiestPart(nominal, channel); !where.empty()) entry.apart.push_back(where);
  noteOutliers(entry, nominal, channel, all.budget.outlier_share);
  return entry;
}

}  // namespace

std::vector<BudgetEntry> budgetOf(const NoiseModel& noise, const Linearization& nominal) {
  std::vector<BudgetEntry> entries;
  for (std::size_t k = 0; k < noise.scales.size(); ++k) {
    const VarianceComponent& c = noise.budget.components[k];
    const EstimatedScale& own = noise.scales[k];
    if (own.amount == 0) continue;  // no reading tells of it
    BudgetEntry& entry = entries.emplace_back();
    std::tie(entry.component, entry.unit, entry.source) = std::tie(c.name, c.unit, c.source);
    std::tie(entry.prior, entry.estimate) = std::tie(c.sigma, own.scale);
    entry.log_sd = own.log_sd;
    // What 99 % of such are at most is no mismatch, however it is spread.
    entry.beyond = own.amount > c.sigma * c.factor ? own.beyond : 0;
    if (!noise.apart.empty()) addApart(entry, c, noise.apart[k], nominal);
  }
  for (const Channel channel : kEveryChannel)
    if (noise.of(channel).rows > 0 && channel != kChannel<Prior>)
      entries.push_back(entryOf(channel, noise, nominal));
  for (BudgetEntry& entry : entries) entry.bursts = entry.beyond > kBursts;
  return entries;
}

}  // namespace fathom
