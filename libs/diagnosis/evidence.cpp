#include "diagnosis/evidence.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"

namespace fathom {
namespace {

// Fisher scoring: ends where no scale moves by a thousandth of itself; no step is longer than a factor of e.
constexpr int kMostSteps = 100, kMostHalvings = 20;
constexpr double kConverged = 1e-3, kLongestStep = 1.0;

std::vector<Eigen::Index> columnsIn(const Eigen::VectorXd& sigma) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < sigma.size(); ++k)
    if (sigma[k] > 0) columns.push_back(k);
  return columns;
}

/// Values in units of their priors: u ~ N(0, 1), M = 1 + D A D.
struct Scaled {
  Eigen::VectorXd sigma, score;
  SymmetricFactors M;

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
    const Eigen::MatrixXd inverse = inverseOf(Eigen::MatrixXd::Identity(S.rows(), S.cols()) + S);
    const Eigen::VectorXd w = inverse * sigma.cwiseProduct(score_);
    const Eigen::MatrixXd told = (S * inverse).array().square();
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
  const ScaleLikelihood likelihood(gram, score, sigma, groups);
  Eigen::VectorXd logs(std::ssize(groups));
  for (Eigen::Index k = 0; k < logs.size(); ++k)
    logs[k] = std::log(groups[static_cast<std::size_t>(k)].scale);
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

}  // namespace fathom
