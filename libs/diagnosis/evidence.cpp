#include "diagnosis/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/linear_algebra.h"

namespace fathom {
namespace {

// Fisher scoring: ends where no scale moves by a hundredth of itself; no step is longer than a factor of e^3.
constexpr int kMostSteps = 100, kMostHalvings = 20;
constexpr double kConverged = 0.01, kLongestStep = 3.0;

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

  double logBayesFactor() const { return 0.5 * (score.dot(M.solve(score)) - M.logDeterminant()); }
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

/// ln of the likelihood of scales and their prior, with its slope and its expected curvature by their
/// logarithms.
///
/// V = 1 + C D^2 C^T. Of d ln L / d ln s_k the part of a column is w^2 - m, w = (1 + S)^-1 D g its value in
/// units of the prior, S = D A D, m = diag(S (1 + S)^-1) what the readings tell of it; the information is
/// 2 sum (S (1 + S)^-1)_ij^2 over the columns of both groups.
class ScaleLikelihood {
 public:
  ScaleLikelihood(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score, const Eigen::VectorXd& sigma,
                  const std::vector<ScaledColumns>& groups)
      : gram_(gram), score_(score), sigma_(sigma), groups_(groups) {}

  double at(const Eigen::VectorXd& logs) const {
    return logBayesFactor(gram_, score_, sigmaAt(logs)) - 0.5 * off(logs).squaredNorm();
  }

  struct Slope {
    Eigen::VectorXd slope;
    Eigen::MatrixXd information;
  };
  Slope slopeAt(const Eigen::VectorXd& logs) const {
    const Eigen::VectorXd sigma = sigmaAt(logs);
    const Eigen::MatrixXd S = sigma.asDiagonal() * gram_ * sigma.asDiagonal();
    const auto size = S.rows();
    const Eigen::MatrixXd inverse = PositiveFactors(Eigen::MatrixXd::Identity(size, size) + S)
                                        .solve(Eigen::MatrixXd::Identity(size, size));
    const Eigen::VectorXd w = inverse * sigma.cwiseProduct(score_);
    // S (1 + S)^-1 = 1 - (1 + S)^-1.
    const Eigen::MatrixXd told = (Eigen::MatrixXd::Identity(size, size) - inverse).array().square();
    const Eigen::VectorXd by_column = w.array().square() - (1 - inverse.diagonal().array());
    const auto count = std::ssize(groups_);
    Slope result{-off(logs), Eigen::MatrixXd::Zero(count, count)};
    for (Eigen::Index k = 0; k < count; ++k) {
      const ScaledColumns& a = group(k);
      result.slope[k] = result.slope[k] / a.log_sd + by_column.segment(a.first, a.size).sum();
      for (Eigen::Index l = 0; l < count; ++l)
        result.information(k, l) = 2 * told.block(a.first, group(l).first, a.size, group(l).size).sum();
      result.information(k, k) += 1 / (a.log_sd * a.log_sd);
    }
    return result;
  }

 private:
  const ScaledColumns& group(Eigen::Index k) const { return groups_[static_cast<std::size_t>(k)]; }
  /// In sigmas of the prior.
  Eigen::VectorXd off(const Eigen::VectorXd& logs) const {
    Eigen::VectorXd off(logs.size());
    for (Eigen::Index k = 0; k < logs.size(); ++k)
      off[k] = (logs[k] - std::log(group(k).scale)) / group(k).log_sd;
    return off;
  }
  Eigen::VectorXd sigmaAt(const Eigen::VectorXd& logs) const {
    Eigen::VectorXd sigma = sigma_;
    for (Eigen::Index k = 0; k < logs.size(); ++k)
      sigma.segment(group(k).first, group(k).size).setConstant(std::exp(logs[k]));
    return sigma;
  }

  const Eigen::MatrixXd& gram_;
  const Eigen::VectorXd &score_, &sigma_;
  const std::vector<ScaledColumns>& groups_;
};

}  // namespace

std::vector<EstimatedScale> likeliestScales(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                                            Eigen::VectorXd sigma, const std::vector<ScaledColumns>& groups) {
  if (groups.empty()) return {};
  const ScaleLikelihood likelihood(gram, score, sigma, groups);
  Eigen::VectorXd logs(std::ssize(groups));
  for (Eigen::Index k = 0; k < logs.size(); ++k) {
    const ScaledColumns& group = groups[static_cast<std::size_t>(k)];
    logs[k] = std::log(group.start > 0 ? group.start : group.scale);
  }
  double best = likelihood.at(logs);
  for (int step = 0; step < kMostSteps; ++step) {
    const auto [slope, information] = likelihood.slopeAt(logs);
    Eigen::VectorXd move = solveSymmetric(information, slope);
    move *= std::min(1.0, kLongestStep / std::max(1e-300, move.cwiseAbs().maxCoeff()));
    double found = likelihood.at(logs + move);
    for (int halving = 0; !(found >= best) && halving < kMostHalvings; ++halving) {
      move *= 0.5;
      found = likelihood.at(logs + move);
    }
    if (!(found >= best)) break;
    logs += move;
    best = found;
    if (move.cwiseAbs().maxCoeff() < kConverged) break;
  }
  const Eigen::MatrixXd covariance = inverseOf(likelihood.slopeAt(logs).information);
  std::vector<EstimatedScale> scales;
  for (Eigen::Index k = 0; k < logs.size(); ++k)
    scales.push_back({std::exp(logs[k]), std::sqrt(covariance(k, k))});
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
        if (found <= best) continue;
        best = found;
        changed = changed || t != kept;
        kept = t;
      }
      set.size[e] = kept;
      own.segment(first, columns[e]) = kept * sigma.segment(first, columns[e]);
      first += columns[e];
    }
  }
  set.evidence = evidenceOf(gram, score, own);
  set.log_bayes_factor = columns.empty() ? 0 : best;
  return set;
}

}  // namespace fathom
