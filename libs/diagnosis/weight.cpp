#include "diagnosis/weight.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "diagnosis/constants.h"
#include "diagnosis/reduced_fit.h"
#include "effects/catalogue.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

/// As one expects of an effect; where and when it is, as it is held.
Eigen::VectorXd usualSizes(const Linearization& linear, const std::vector<Candidate>& effects) {
  std::vector<double> sigmas;
  for (const Candidate& effect : effects)
    for (const CandidateColumn& c : columnsOf(linear, effect.effect)) {
      const EffectColumn& column = linear.columns[c.column];
      const Parameter& parameter = parameterOf(column.scalar);
      sigmas.push_back(isPeak(parameter.kind) ? column.prior_sigma : parameter.prior_sigma);
    }
  return Eigen::Map<Eigen::VectorXd>(sigmas.data(), std::ssize(sigmas));
}

/// Looked for from the declared scales, or from those that were enough where less was left out: not from
/// larger ones, among which the budget makes up for an effect.
std::vector<ScaledColumns> groupsOf(const NoiseModel& noise, const HeldColumns& budget) {
  std::vector<ScaledColumns> groups;
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < budget.sizes.size(); ++k) {
    const VarianceComponent& component = noise.budget.components[k];
    groups.push_back({first, budget.sizes[k], component.sigma, component.logSd(),
                      std::min(component.sigma, noise.sigmaOf(k))});
    first += budget.sizes[k];
  }
  return groups;
}

/// ln of the probability that what cannot be less than nothing is more, over one half.
double logOfPositive(const Linearization& linear, const std::vector<Candidate>& effects,
                     const Evidence& evidence) {
  double sum = 0;
  Eigen::Index k = 0;
  for (const Candidate& effect : effects)
    for (const CandidateColumn& c : columnsOf(linear, effect.effect)) {
      const Parameter& parameter = parameterOf(linear.columns[c.column].scalar);
      if (parameter.positive && parameter.kind != ParameterKind::spread)
        sum +=
            std::log(std::max(1e-300, std::erfc(-evidence.value[k] /
                                                std::sqrt(2 * std::max(1e-300, evidence.covariance(k, k))))));
      ++k;
    }
  return sum;
}

/// Readings that what is taken into account explains are no outliers.
bool reweigh(Linearization& linear, HeldColumns& budget, const Eigen::VectorXd& left) {
  std::vector<Channel> channels;
  for (const Channel channel : kEveryChannel)
    if (textOf(channel).has_outliers) channels.push_back(channel);
  const auto weights = [&] {
    Eigen::VectorXd all(std::ssize(linear.rows));
    for (Eigen::Index i = 0; i < all.size(); ++i)
      all[i] = linear.rows[static_cast<std::size_t>(i)].robust_weight;
    return all;
  };
  const Eigen::VectorXd before = weights();
  if (!applyOtherRobustWeights(linear, channels, left)) return false;
  budget.columns = weights().cwiseQuotient(before).cwiseSqrt().asDiagonal() * budget.columns;
  return true;
}

/// The likeliest scales and sizes, by turns: what the budget has to make up for depends on how large the
/// effects may be.
struct Likeliest {
  std::vector<double> scales;
  Eigen::VectorXd sigma;  ///< of all columns, so
  Split split;
};
Likeliest likeliest(const ReducedFit& hypothesis, const Linearization& linear,
                    const std::vector<Candidate>& effects, std::vector<ScaledColumns> groups) {
  const Eigen::VectorXd usual = usualSizes(linear, effects);
  std::vector<Eigen::Index> widths;
  for (const Candidate& effect : effects) widths.push_back(std::ssize(columnsOf(linear, effect.effect)));
  const Eigen::Index unheld = hypothesis.unheld(), q = hypothesis.budget().sigma.size() + unheld;
  Likeliest found;
  Eigen::VectorXd& sigma = found.sigma;
  sigma.resize(q + usual.size());
  // What effects of any size can explain is not the budget's, to begin with.
  sigma << hypothesis.budget().sigma, Eigen::VectorXd::Constant(unheld, ReducedFit::kUnheld),
      EffectEvidence::kSizes.back() * usual;
  for (int round = 0; round < (effects.empty() ? 1 : kScaleRounds); ++round) {
    found.scales = likeliestScales(hypothesis.gram(), hypothesis.score(), sigma, groups);
    for (std::size_t k = 0; k < groups.size(); ++k) {
      groups[k].start = found.scales[k];
      sigma.segment(groups[k].first, groups[k].size).setConstant(found.scales[k]);
    }
    found.split = hypothesis.split(sigma, usual, widths);
    Eigen::Index first = q;
    for (std::size_t e = 0; e < effects.size(); first += widths[e++])
      sigma.segment(first, widths[e]) = found.split.effects.size[e] * usual.segment(first - q, widths[e]);
  }
  return found;
}

/// Of columns C of values u, |C u| by |C|: as much as values of one each would do on average.
double amountOf(const Eigen::SparseMatrix<double>& all, const std::vector<Eigen::Index>& columns,
                const Eigen::VectorXd& values) {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(all.rows());
  double of_one = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    change += all.col(columns[i]) * values[static_cast<Eigen::Index>(i)];
    of_one += all.col(columns[i]).squaredNorm();
  }
  return of_one > 0 ? change.norm() / std::sqrt(of_one) : 0;
}

/// See EstimatedScale::amount.
void noteAmounts(std::vector<EstimatedScale>& scales, const HeldColumns& budget,
                 const Eigen::VectorXd& values) {
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < scales.size(); first += budget.sizes[k++]) {
    std::vector<Eigen::Index> own(static_cast<std::size_t>(budget.sizes[k]));
    std::iota(own.begin(), own.end(), first);
    scales[k].amount = amountOf(budget.columns, own, values.segment(first, budget.sizes[k]));
  }
}

/// ln of how likely the scales are beforehand, beside the declared ones.
double logPriorOf(const std::vector<EstimatedScale>& scales, const std::vector<ScaledColumns>& groups) {
  double sum = 0;
  for (std::size_t k = 0; k < groups.size(); ++k)
    sum -= 0.5 * std::pow(std::log(scales[k].scale / groups[k].scale) / groups[k].log_sd, 2);
  return sum;
}

/// Whether its owners are somewhere on the panel, and no effect of the catalogue is one of them elsewhere: a
/// marker that was moved is named.
bool mayBeApart(const VarianceComponent& component) {
  const bool has_place = component.each == VarianceComponent::Each::marker ||
                         component.each == VarianceComponent::Each::place ||
                         component.each == VarianceComponent::Each::spot;
  return has_place && std::none_of(component.by.begin(), component.by.end(), [](const std::string& by) {
           return findEffect(by.substr(0, by.find('.'))) != nullptr;
         });
}

/// What an owner's values amount to: how many numbers they are, and their mean square.
struct OwnersValues {
  double count = 0, square = 0;
};

/// Of the component whose columns begin at `first`. A field's values at one place are one number, as large as
/// what readings tell of it, see amountOf(): of a single node they may tell little.
std::map<Owner, OwnersValues> valuesByOwner(const HeldColumns& budget, const VarianceComponent& component,
                                            Eigen::Index first, Eigen::Index size,
                                            const Eigen::VectorXd& values) {
  std::map<Owner, std::vector<Eigen::Index>> columns;
  for (Eigen::Index column = first; column < first + size; ++column)
    columns[budget.owners[static_cast<std::size_t>(column)]].push_back(column);
  std::map<Owner, OwnersValues> all;
  for (const auto& [owner, own] : columns) {
    const Eigen::VectorXd of_owner = values(own);
    all[owner] = component.smooth ? OwnersValues{1, std::pow(amountOf(budget.columns, own, of_owner), 2)}
                                  : OwnersValues{static_cast<double>(own.size()),
                                                 of_owner.squaredNorm() / std::ssize(own)};
  }
  return all;
}

/// Adds the owners whose values are not of their component's kind; whether there are any.
bool setApart(NoiseModel& noise, const HeldColumns& budget, const Eigen::VectorXd& values) {
  noise.apart.resize(budget.sizes.size());
  bool has_more = false;
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < budget.sizes.size(); first += budget.sizes[k++]) {
    const VarianceComponent& component = noise.budget.components[k];
    if (!mayBeApart(component)) continue;
    const auto found = valuesByOwner(budget, component, first, budget.sizes[k], values);
    const double largest = component.sigma * component.factor;
    const auto owners = static_cast<double>(found.size() + noise.apart[k].size());
    std::map<Owner, double> all = noise.apart[k];
    for (const auto& [owner, own] : found)
      if (chiSquareLogTail(own.count, own.count * own.square / (largest * largest)) <
          std::log(kApart_p / owners))
        all[owner] = std::sqrt(own.square);
    if (all.size() == noise.apart[k].size() || static_cast<double>(all.size()) > kMostApart * owners)
      continue;
    noise.apart[k] = std::move(all);
    has_more = true;
  }
  return has_more;
}

/// ln of how likely it is beforehand that these owners are apart, the further the less.
double logPriorOfApart(const NoiseModel& noise) {
  double sum = 0;
  for (std::size_t k = 0; k < noise.apart.size(); ++k)
    for (const auto& [owner, sigma] : noise.apart[k])
      sum += std::log(kExpectedApart * std::min(1.0, noise.budget.components[k].sigma / sigma));
  return sum;
}

/// By how much a robust loss exceeds half the square of what is left of the readings that it makes light of.
double robustShare(const Linearization& linear, const Eigen::VectorXd& left) {
  double sum = 0;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel != kChannel<Prior>)
      sum += 0.5 * (1 - linear.rows[i].robust_weight) * std::pow(left[static_cast<Eigen::Index>(i)], 2);
  return sum;
}

/// Columns that readings' residuals have with the opposite sign are of components of the one or the other
/// kind.
void noteLight(Weight& weight, const Linearization& linear, const NoiseModel& noise,
               const HeldColumns& budget, const Eigen::VectorXd& values, const Eigen::VectorXd& change) {
  Eigen::VectorXd of_reflected = Eigen::VectorXd::Zero(budget.sigma.size()), of_level = of_reflected;
  const auto take = [&](std::size_t component, Eigen::Index column) {
    const std::vector<std::string>& by = noise.budget.components[component].by;
    if (by.front() == "pixels.reflected") of_reflected[column] = values[column];
    if (by.front() == "pixels.level") of_level[column] = values[column];
  };
  Eigen::Index column = 0;
  for (std::size_t k = 0; k < budget.sizes.size(); ++k)
    for (const Eigen::Index end = column + budget.sizes[k]; column < end; ++column) take(k, column);
  for (const std::size_t k : budget.of_apart) take(k, column++);
  weight.reflected = -(budget.columns * of_reflected);
  weight.level = -(budget.columns * of_level);
  weight.moved = -change - weight.reflected - weight.level;
  for (Eigen::Index i = 0; i < weight.level.size(); ++i) {
    const RowInfo& row = linear.rows[static_cast<std::size_t>(i)];
    const double unit = row.per_unit * std::sqrt(row.robust_weight);
    weight.moved[i] = row.patch >= 0 ? weight.moved[i] / unit : 0;
    weight.reflected[i] = row.reflected > 0 ? weight.reflected[i] / (unit * row.reflected) : 0;
    weight.level[i] = row.level > 0 ? weight.level[i] / (unit * row.level) : 0;
  }
}

}  // namespace

Weight weigh(Linearization& linear, HeldColumns& budget, const std::vector<Candidate>& effects,
             const BatchState& state, const NoiseModel& assumed) {
  Weight weight;
  NoiseModel noise = assumed;
  Likeliest found;
  for (int round = 0;; ++round) {
    const ReducedFit hypothesis(linear, effects, state, noise, budget);
    std::vector<ScaledColumns> groups = groupsOf(noise, budget);
    // From where the round before ended.
    for (std::size_t k = 0; k < found.scales.size(); ++k) groups[k].start = found.scales[k];
    found = likeliest(hypothesis, linear, effects, groups);
    const Split& split = found.split;
    const Eigen::VectorXd left = hypothesis.leftBy(split);
    if (round + 1 < kReweighed) {
      const bool has_others = reweigh(linear, budget, left), has_more = setApart(noise, budget, split.budget);
      if (has_more) budget = budgetColumns(linear, noise);
      if (has_others || has_more) continue;
    }
    weight.apart = noise.apart;
    weight.values = split.effects.evidence.value;
    weight.step = hypothesis.stepBy(split);
    const Eigen::VectorXd change = hypothesis.changeByBudget(split);
    weight.left = left - change;
    noteLight(weight, linear, noise, budget, split.budget, change);
    weight.log_bayes_factor = split.effects.log_bayes_factor;
    weight.effects = evidenceOf(split.gram, split.score, priorSigmas(linear, effects));
    weight.scales = estimatedScales(hypothesis.gram(), hypothesis.score(), found.sigma, groups, found.scales);
    noteAmounts(weight.scales, budget, split.budget);
    weight.log_evidence = hypothesis.logEvidence(split) - robustShare(linear, hypothesis.whitened(left)) +
                          logPriorOf(weight.scales, groups) + logPriorOfApart(noise) +
                          split.effects.log_bayes_factor +
                          logOfPositive(linear, effects, split.effects.evidence);
    return weight;
  }
}

}  // namespace fathom
