#include "diagnosis/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "core/linear_algebra.h"
#include "diagnosis/constants.h"
#include "diagnosis/error_budget.h"

namespace fathom {
namespace {

std::vector<Eigen::Index> columnsIn(const Eigen::VectorXd& sigma) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < sigma.size(); ++k)
    if (sigma[k] > 0) columns.push_back(k);
  return columns;
}

/// Values in units of their priors: u ~ N(0, 1), M = 1 + D A D.
struct Scaled {
  Eigen::VectorXd sigma, score;
  PositiveFactors M;

  Scaled(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score_of_all, const Eigen::VectorXd& own)
      : sigma(own),
        score(own.cwiseProduct(score_of_all)),
        M(Eigen::MatrixXd::Identity(own.size(), own.size()) + own.asDiagonal() * gram * own.asDiagonal()) {}

  /// Impossible where readings weigh so much that rounding is all that is left.
  double logBayesFactor() const {
    return M.succeeded() ? 0.5 * (score.dot(M.solve(score)) - M.logDeterminant())
                         : -std::numeric_limits<double>::infinity();
  }
};

}  // namespace

Evidence evidenceOf(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score, const Eigen::VectorXd& sigma) {
  const std::vector<Eigen::Index> own = columnsIn(sigma);
  const Scaled scaled(gram(own, own), score(own), sigma(own));
  Evidence evidence{scaled.logBayesFactor(), Eigen::VectorXd::Zero(sigma.size()),
                    Eigen::MatrixXd::Zero(sigma.size(), sigma.size())};
  evidence.value(own) = -scaled.sigma.cwiseProduct(scaled.M.solve(scaled.score));
  const Eigen::MatrixXd D = scaled.sigma.asDiagonal();
  evidence.covariance(own, own) = D * scaled.M.solve(D);
  return evidence;
}

double logBayesFactor(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                      const Eigen::VectorXd& sigma) {
  const std::vector<Eigen::Index> own = columnsIn(sigma);
  return Scaled(gram(own, own), score(own), sigma(own)).logBayesFactor();
}

namespace {

constexpr auto& kSizes = EffectEvidence::kSizes;

/// ln of how likely a size is beforehand: of those above 1 like the tail of Cauchy's distribution.
double logShareOf(double size) {
  double sum = 0;
  for (const double t : kSizes) sum += std::min(1.0, 1 / t);
  return std::log(std::min(1.0, 1 / size) / sum);
}

/// ln of the likelihood of scales and their prior at a place, with its slope and curvatures by their
/// logarithms.
///
/// V = 1 + C D^2 C^T. Of d ln L / d ln s_k the part of a column is w^2 - m, w = (1 + S)^-1 D g its value in
/// units of the prior, S = D A D, m = diag(T) what the readings tell of it, T = S (1 + S)^-1 = 1 - (1 +
/// S)^-1. The curvature expected is 2 sum T_ij^2 over the columns of both groups; the mean of that and the
/// one observed, 2 w_k^T T w_l, leads there in a third of the steps (Gilmour, Thompson & Cullis 1995).
class ScaleLikelihood {
 public:
  ScaleLikelihood(const BlockedMatrix& gram, const Eigen::VectorXd& score, const Eigen::VectorXd& sigma,
                  const std::vector<ScaledColumns>& groups)
      : gram_(gram), score_(score), sigma_(sigma), groups_(groups) {}

  struct At {
    Eigen::VectorXd logs, off;  ///< the second: in sigmas of the prior
    BlockedFactors M;
    Eigen::VectorXd score;        ///< scaled
    double log_bayes_factor = 0;  ///< but for what is the same for all scales
    double value = 0;
  };
  std::unique_ptr<At> at(const Eigen::VectorXd& logs) const {
    Eigen::VectorXd off(logs.size()), sigma = sigma_;
    for (Eigen::Index k = 0; k < logs.size(); ++k) {
      off[k] = (logs[k] - std::log(group(k).scale)) / group(k).log_sd;
      sigma.segment(group(k).first, group(k).size).setConstant(std::exp(logs[k]));
    }
    auto at = std::make_unique<At>(At{logs, off, BlockedFactors(gram_, sigma), {}, 0, 0});
    at->score = at->M.units().cwiseProduct(score_);
    at->log_bayes_factor = at->M.succeeded()
                               ? 0.5 * (at->score.dot(at->M.solve(at->score).col(0)) - at->M.logDeterminant())
                               : -std::numeric_limits<double>::infinity();
    at->value = at->log_bayes_factor - 0.5 * off.squaredNorm();
    return at;
  }

  /// The step that leads to the top, and what it would gain, were the curvature the same everywhere.
  struct Step {
    Eigen::VectorXd move;
    double gain = 0;
  };
  Step stepFrom(const At& at) const {
    const Eigen::VectorXd w = at.M.solve(at.score);
    const Eigen::VectorXd by_column = w.array().square() - (1 - at.M.inverseDiagonal().array());
    const auto count = std::ssize(groups_);
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(w.size(), count);
    Eigen::VectorXd slope(count), held(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto& [first, size, scale, log_sd, start] = group(k);
      own.col(k).segment(first, size) = w.segment(first, size);
      slope[k] = by_column.segment(first, size).sum() - at.off[k] / log_sd;
      held[k] = 1 / (log_sd * log_sd);
    }
    Eigen::MatrixXd curvature = 2 * own.transpose() * (own - at.M.solve(own));
    curvature.diagonal() += held;
    const Eigen::VectorXd move = solveSymmetric(curvature, slope);
    return {move, 0.5 * move.dot(slope)};
  }

  /// Of the scales' logarithms, by the curvature expected.
  Eigen::MatrixXd covarianceAt(const At& at) const {
    const Eigen::MatrixXd inverse = at.M.inverse();
    const auto count = std::ssize(groups_);
    Eigen::MatrixXd information(count, count);
    for (Eigen::Index k = 0; k < count; ++k)
      for (Eigen::Index l = 0; l < count; ++l) {
        const ScaledColumns &a = group(k), &b = group(l);
        Eigen::MatrixXd told = -inverse.block(a.first, b.first, a.size, b.size);
        if (k == l) told.diagonal().array() += 1;
        information(k, l) = 2 * told.squaredNorm() + (k == l ? 1 / (a.log_sd * a.log_sd) : 0);
      }
    return inverseOf(information);
  }

 private:
  const ScaledColumns& group(Eigen::Index k) const { return groups_[static_cast<std::size_t>(k)]; }

  const BlockedMatrix& gram_;
  const Eigen::VectorXd &score_, &sigma_;
  const std::vector<ScaledColumns>& groups_;
};

/// Steps that overshoot by the same share each time, or fall short, are seen through after two (Anderson
/// 1965).
class Accelerated {
 public:
  /// Where to go from there, where the plain step would be so long.
  Eigen::VectorXd next(const Eigen::VectorXd& at, const Eigen::VectorXd& move) {
    if (move.cwiseAbs().maxCoeff() > kUnsteadyStep) return at + move;
    steps_.push_back({at, move});
    if (std::ssize(steps_) > kAccelerated + 1) steps_.erase(steps_.begin());
    const auto columns = std::ssize(steps_) - 1;
    Eigen::MatrixXd by_place(at.size(), columns), by_move(at.size(), columns);
    for (Eigen::Index k = 0; k < columns; ++k) {
      const auto [from, its] = steps_[static_cast<std::size_t>(k)];
      by_place.col(k) = at - from;
      by_move.col(k) = move - its;
    }
    if (columns == 0) return at + move;
    const Eigen::VectorXd share =
        solveSymmetric(transposedTimesItself(by_move), (by_move.transpose() * move).eval());
    return at + move - (by_place + by_move) * share;
  }

 private:
  struct Step {
    Eigen::VectorXd at, move;
  };
  std::vector<Step> steps_;
};

}  // namespace

std::vector<double> likeliestScales(const BlockedMatrix& gram, const Eigen::VectorXd& score,
                                    const Eigen::VectorXd& sigma, const std::vector<ScaledColumns>& groups) {
  if (groups.empty()) return {};
  const ScaleLikelihood likelihood(gram, score, sigma, groups);
  Eigen::VectorXd logs(std::ssize(groups));
  for (Eigen::Index k = 0; k < logs.size(); ++k) {
    const ScaledColumns& group = groups[static_cast<std::size_t>(k)];
    logs[k] = std::log(group.start > 0 ? group.start : group.scale);
  }
  auto best = likelihood.at(logs);
  Accelerated accelerated;
  for (int step = 0; step < kMostSteps; ++step) {
    auto [move, gain] = likelihood.stepFrom(*best);
    if (gain < kConverged) break;
    move *= std::min(1.0, kLongestStep / std::max(1e-300, move.cwiseAbs().maxCoeff()));
    auto found = likelihood.at(accelerated.next(best->logs, move));
    for (int halving = 0; !(found->value >= best->value) && halving < kMostHalvings; ++halving) {
      found = likelihood.at(best->logs + move);
      move *= 0.5;
    }
    if (!(found->value >= best->value)) break;
    best = std::move(found);
  }
  std::vector<double> scales;
  for (Eigen::Index k = 0; k < logs.size(); ++k) scales.push_back(std::exp(best->logs[k]));
  return scales;
}

std::vector<EstimatedScale> estimatedScales(const BlockedMatrix& gram, const Eigen::VectorXd& score,
                                            const Eigen::VectorXd& sigma,
                                            const std::vector<ScaledColumns>& groups,
                                            const std::vector<double>& likeliest) {
  if (groups.empty()) return {};
  const ScaleLikelihood likelihood(gram, score, sigma, groups);
  const Eigen::VectorXd logs =
      Eigen::Map<const Eigen::ArrayXd>(likeliest.data(), std::ssize(likeliest)).log().matrix();
  const auto best = likelihood.at(logs);
  const Eigen::MatrixXd covariance = likelihood.covarianceAt(*best);
  std::vector<EstimatedScale> scales;
  for (Eigen::Index k = 0; k < logs.size(); ++k) {
    const ScaledColumns& group = groups[static_cast<std::size_t>(k)];
    scales.push_back({likeliest[static_cast<std::size_t>(k)], std::sqrt(covariance(k, k)), 0});
    Eigen::VectorXd largest = logs;
    largest[k] = std::log(group.scale) + kSigmasOf99 * group.log_sd;
    if (logs[k] > largest[k])
      scales.back().beyond = best->log_bayes_factor - likelihood.at(largest)->log_bayes_factor;
  }
  return scales;
}

EffectEvidence::EffectEvidence(const Eigen::MatrixXd& gram, const Eigen::VectorXd& sigma) {
  if (gram.rows() == 0) return;
  SymmetricEigen eigen = eigenOf(sigma.asDiagonal() * gram * sigma.asDiagonal());
  values_ = eigen.values.cwiseMax(0.0);
  scaled_basis_ = sigma.asDiagonal() * eigen.vectors;
  for (std::size_t k = 0; k < kSizes.size(); ++k)
    at_no_score_[k] = logShareOf(kSizes[k]) - 0.5 * (1 + kSizes[k] * kSizes[k] * values_.array()).log().sum();
}

EffectEvidence::Best EffectEvidence::best(const Eigen::VectorXd& score) const {
  std::array<double, kSizes.size()> found = at_no_score_;
  for (Eigen::Index i = 0; i < values_.size(); ++i) {
    const double along = scaled_basis_.col(i).dot(score), square = along * along;
    for (std::size_t k = 0; k < kSizes.size(); ++k) {
      const double t2 = kSizes[k] * kSizes[k];
      found[k] += 0.5 * t2 * square / (1 + t2 * values_[i]);
    }
  }
  const auto best = std::max_element(found.begin(), found.end());
  return {*best, kSizes[static_cast<std::size_t>(best - found.begin())]};
}

Eigen::VectorXd EffectEvidence::valueAt(const Eigen::VectorXd& score, double size) const {
  const double t2 = size * size;
  const Eigen::VectorXd along = scaled_basis_.transpose() * score;
  return -scaled_basis_ * (t2 * along.array() / (1 + t2 * values_.array())).matrix();
}

double logBayesFactorOf(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                        const Eigen::VectorXd& sigma, const std::vector<double>& sizes) {
  double share = 0;
  for (const double t : sizes) share += logShareOf(t);
  return logBayesFactor(gram, score, sigma) + share;
}

SizedSet bestSizes(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score, const Eigen::VectorXd& sigma,
                   const std::vector<Eigen::Index>& columns) {
  SizedSet set{0, std::vector<double>(columns.size(), 1), {}};
  Eigen::VectorXd own = sigma;
  double best = -std::numeric_limits<double>::infinity();
  const auto worth = [&] {
    double share = 0;
    for (const double t : set.size) share += logShareOf(t);
    return logBayesFactor(gram, score, own) + share;
  };
  // One after the other, until none would be of another size.
  for (bool changed = !columns.empty(); changed;) {
    changed = false;
    Eigen::Index first = 0;
    for (std::size_t e = 0; e < columns.size(); ++e) {
      double kept = set.size[e];
      for (const double t : kSizes) {
        set.size[e] = t;
        own.segment(first, columns[e]) = t * sigma.segment(first, columns[e]);
        const double found = worth();
        if (!(found > best)) continue;
        best = found;
        changed = changed || t != kept;
        kept = t;
      }
      set.size[e] = kept;
      own.segment(first, columns[e]) = kept * sigma.segment(first, columns[e]);
      first += columns[e];
    }
  }
  if (!columns.empty() && !std::isfinite(best)) throw Singular("readings weigh more than rounding");
  set.evidence = evidenceOf(gram, score, own);
  set.log_bayes_factor = columns.empty() ? 0 : best;
  return set;
}

}  // namespace fathom
