#include "diagnosis/adequacy.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/chi_square.h"
#include "core/stable_sort.h"
#include "diagnosis/constants.h"
#include "diagnosis/covariate.h"
#include "diagnosis/screening.h"

namespace fathom {
namespace {

/// The covariates of all channels that an effect acts on, by name.
std::map<std::string, Covariate> covariatesOf(const Linearization& linear, const Eigen::VectorXd& change) {
  std::map<std::string, Covariate> covariates;
  for (const Channel channel : kEveryChannel) {
    double square = 0;
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].channel == channel) square += std::pow(change[static_cast<Eigen::Index>(i)], 2);
    // What hardly matters to the effect says hardly anything about it.
    if (square < 0.05 * change.squaredNorm()) continue;
    for (Covariate& covariate : covariatesOf(linear, channel))
      covariates.try_emplace(covariate.name, std::move(covariate));
  }
  return covariates;
}

}  // namespace

std::vector<InteractionTest> interactionTests(const Refit& fit, const Candidate& effect) {
  const Linearization& linear = fit.model->linear();
  const Eigen::VectorXd change = changeBy(fit, effect, linear);
  const auto covariates = covariatesOf(linear, change);
  std::vector<std::string> names;
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& entry : covariates) {
    const Covariate& covariate = entry.second;
    double weight = 0, mean = 0, square = 0;
    const auto of = [&](std::size_t i) {
      const double z = covariate.of(linear.rows[i]);
      return std::isfinite(z) ? z : mean;
    };
    for (std::size_t i = 0; i < linear.rows.size(); ++i) {
      const double w = change[static_cast<Eigen::Index>(i)] * change[static_cast<Eigen::Index>(i)];
      if (w == 0 || !std::isfinite(covariate.of(linear.rows[i]))) continue;
      weight += w;
      mean += w * covariate.of(linear.rows[i]);
      square += w * covariate.of(linear.rows[i]) * covariate.of(linear.rows[i]);
    }
    if (weight == 0) continue;
    mean /= weight;
    const double spread = std::sqrt(std::max(0.0, square / weight - mean * mean));
    if (spread < 1e-9) continue;
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (const double c = change[static_cast<Eigen::Index>(i)]; c != 0)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(names.size()),
                             c * (of(i) - mean) / spread);
    names.push_back(entry.first);
  }
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), std::ssize(names));
  columns.setFromTriplets(entries.begin(), entries.end());
  const Reduced reduced = fit.model->reduce(columns);
  std::vector<InteractionTest> tests;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    const Information information(reduced.gram.block(c, c, 1, 1), reduced.norms.segment(c, 1));
    if (information.rank == 0) continue;
    InteractionTest test;
    test.against = names[i];
    test.statistic = reduced.score[c] * reduced.score[c] * information.inverse(0, 0);
    test.log_p =
        std::min(0.0, chiSquareLogTail(1, test.statistic) + std::log(static_cast<double>(names.size())));
    test.relative_change = -information.inverse(0, 0) * reduced.score[c];
    test.failed = test.log_p < std::log(kFailed_p) && std::abs(test.relative_change) > kLeastChange;
    tests.push_back(std::move(test));
  }
  stableSort(tests, [](const auto& a, const auto& b) { return a.log_p < b.log_p; });
  return tests;
}

bool hasFailed(const std::vector<InteractionTest>& tests) {
  return std::any_of(tests.begin(), tests.end(), [](const InteractionTest& test) { return test.failed; });
}

}  // namespace fathom
