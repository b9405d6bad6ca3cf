// What hypotheses are worth, beside the same computed from the readings themselves.
#include "diagnosis/evidence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/random.h"

namespace fathom {
namespace {

/// Readings of some columns, with unknowns that are projected off.
struct Readings {
  Eigen::MatrixXd C, J;
  Eigen::VectorXd r;

  Readings(Eigen::Index rows, Eigen::Index columns, Random& random)
      : C(random.normals(rows, columns)), J(random.normals(rows, 3)), r(Eigen::VectorXd::Zero(rows)) {}

  Eigen::MatrixXd projection() const {
    return Eigen::MatrixXd::Identity(r.size(), r.size()) - J * inverseOf(J.transpose() * J) * J.transpose();
  }
  Eigen::MatrixXd gram() const { return C.transpose() * projection() * C; }
  Eigen::VectorXd score() const { return C.transpose() * projection() * r; }

  /// ln of the readings' density, unknowns as good as free.
  double logDensity(const Eigen::VectorXd& sigma) const {
    constexpr double kFree = 1e6;
    const Eigen::MatrixXd V = Eigen::MatrixXd::Identity(r.size(), r.size()) +
                              C * sigma.cwiseAbs2().asDiagonal() * C.transpose() + kFree * J * J.transpose();
    const SymmetricFactors factors(V);
    return -0.5 * (r.dot(factors.solve(r)) + factors.logDeterminant());
  }
};

// The same to what so free unknowns are off by and what the sums of 1e6 leave of doubles.
TEST(Evidence, IsTheReadingsDensity) {
  Random random(3);
  Readings readings(40, 6, random);
  readings.r = 2 * random.normals(40, 1);
  const Eigen::VectorXd sigma = (Eigen::VectorXd(6) << 0.5, 0, 2, 0.1, 0, 1).finished();
  const Evidence evidence = evidenceOf(readings.gram(), readings.score(), sigma);
  const double expected = readings.logDensity(sigma) - readings.logDensity(Eigen::VectorXd::Zero(6));
  EXPECT_NEAR(evidence.log_bayes_factor, expected, 1e-3);
  EXPECT_DOUBLE_EQ(evidence.log_bayes_factor, logBayesFactor(readings.gram(), readings.score(), sigma));
  EXPECT_EQ(evidence.value[1], 0);
  EXPECT_EQ(evidence.covariance(4, 4), 0);
}

// Values that were drawn: posterior errors are as large as their covariance says. 300 draws of six: the mean
// of their normalized squares is 1 within 5 * sqrt(2 / 1800).
TEST(Evidence, ValuesAreAsGoodAsTheySay) {
  Random random(4);
  const Eigen::VectorXd sigma = (Eigen::VectorXd(6) << 0.5, 0.2, 2, 0.1, 3, 1).finished();
  double square = 0;
  constexpr int kDraws = 300;
  for (int draw = 0; draw < kDraws; ++draw) {
    Readings readings(40, 6, random);
    const Eigen::VectorXd truth = sigma.cwiseProduct(random.normals(6, 1).col(0));
    readings.r = -readings.C * truth + random.normals(40, 1).col(0) + readings.J * Eigen::Vector3d(5, -3, 8);
    const Evidence evidence = evidenceOf(readings.gram(), readings.score(), sigma);
    square += normalizedSquare(evidence.covariance, evidence.value - truth) / (6 * kDraws);
  }
  EXPECT_NEAR(square, 1, 5 * std::sqrt(2.0 / (6 * kDraws)));
}

// Of one effect by itself: the best of its sizes, by the same density.
TEST(EffectEvidence, IsTheBestOfItsSizes) {
  Random random(5);
  Readings readings(40, 3, random);
  const Eigen::VectorXd sigma = (Eigen::VectorXd(3) << 0.5, 1, 2).finished();
  readings.r = -0.05 * readings.C.col(0) + random.normals(40, 1).col(0);
  const EffectEvidence evidence(readings.gram(), sigma);
  double most = -1e300, shares = 0;
  for (const double t : EffectEvidence::kSizes) shares += std::min(1.0, 1 / t);
  for (const double t : EffectEvidence::kSizes)
    most = std::max(most, logBayesFactor(readings.gram(), readings.score(), t * sigma) +
                              std::log(std::min(1.0, 1 / t) / shares));
  const EffectEvidence::Best best = evidence.best(readings.score());
  EXPECT_NEAR(best.log_bayes_factor, most, 1e-9);
  const SizedSet set = bestSizes(readings.gram(), readings.score(), sigma, {3});
  EXPECT_NEAR(set.log_bayes_factor, most, 1e-9);
  EXPECT_EQ(set.size, std::vector<double>{best.size});
  EXPECT_LT((evidence.valueAt(readings.score(), best.size) - set.evidence.value).norm(), 1e-9);
}

// Odds of e^x are seen by chance e^-x as often (Markov): of 4000 draws of noise alone 4 sigmas of their
// number more at most.
TEST(EffectEvidence, SaysNoMoreByChanceThanItMay) {
  Random random(6);
  Readings readings(40, 3, random);
  const EffectEvidence evidence(readings.gram(), Eigen::VectorXd::Constant(3, 0.3));
  constexpr int kDraws = 4000;
  int beyond = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    readings.r = random.normals(40, 1);
    beyond += evidence.best(readings.score()).log_bayes_factor > std::log(20.0);
  }
  EXPECT_LT(beyond, kDraws / 20 + 4 * std::sqrt(kDraws / 20.0));
}

constexpr Eigen::Index kGroup = 40;  // columns

/// Two groups of columns and one that is of none.
Readings readingsOfScales(double first, double second, Random& random) {
  Readings readings(400, 2 * kGroup + 1, random);
  Eigen::VectorXd truth = random.normals(2 * kGroup + 1, 1);
  truth.head(kGroup) *= first;
  truth.segment(kGroup, kGroup) *= second;
  readings.r = -readings.C * truth + random.normals(400, 1).col(0);
  return readings;
}

std::vector<EstimatedScale> scalesOf(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score,
                                     const Eigen::VectorXd& sigma, const std::vector<ScaledColumns>& groups) {
  return estimatedScales(gram, score, sigma, groups, likeliestScales(gram, score, sigma, groups));
}

std::vector<EstimatedScale> scalesOf(const Readings& readings, double log_sd, double prior = 0.3) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(2 * kGroup + 1);
  sigma[2 * kGroup] = 1;
  return scalesOf(readings.gram(), readings.score(), sigma,
                  {{0, kGroup, prior, log_sd}, {kGroup, kGroup, prior, log_sd}});
}

// Of priors that hardly hold: unbiased, and the scatter of the estimates' logarithms is what they say.
TEST(LikeliestScales, AreWhatTheValuesWereDrawnWith) {
  Random random(5);
  double mean = 0, square = 0;
  constexpr int kDraws = 40;
  for (int draw = 0; draw < kDraws; ++draw) {
    const std::vector<EstimatedScale> scales = scalesOf(readingsOfScales(1.5, 0.2, random), 10);
    const std::array off{std::log(scales[0].scale / 1.5), std::log(scales[1].scale / 0.2)};
    for (const std::size_t k : {0u, 1u}) {
      mean += off[k] / scales[k].log_sd / (2 * kDraws);
      square += std::pow(off[k] / scales[k].log_sd, 2) / (2 * kDraws);
      EXPECT_LT(scales[k].log_sd, 0.25);
    }
  }
  EXPECT_NEAR(mean, 0, 0.45);  // 4 / sqrt(80): half of that is the skewness of so few values' scatter
  EXPECT_NEAR(square, 1, 0.6);
}

// The prior is believed as its sigma has it, and burst where the values are far from it.
TEST(LikeliestScales, AreHeldByTheirPriors) {
  Random random(6);
  const Readings readings = readingsOfScales(3.0, 0.3, random);
  const std::vector<EstimatedScale> free = scalesOf(readings, 10), held = scalesOf(readings, 0.3),
                                    fixed = scalesOf(readings, 1e-3);
  EXPECT_NEAR(fixed[0].scale, 0.3, 0.01);
  EXPECT_LT(held[0].scale, free[0].scale);
  EXPECT_GT(held[0].scale, 0.3 * std::exp(2.58 * 0.3));  // beyond its 99 %
  EXPECT_LT(held[1].scale, 0.3 * std::exp(2.58 * 0.3));
}

TEST(LikeliestScales, OfWhatNothingShowsAreThePriors) {
  const Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(4, 4);
  const std::vector<EstimatedScale> scales =
      scalesOf(gram, Eigen::VectorXd::Zero(4), Eigen::VectorXd::Zero(4), {{0, 4, 0.7, 0.5}});
  EXPECT_NEAR(scales[0].scale, 0.7, 1e-9);
  EXPECT_NEAR(scales[0].log_sd, 0.5, 1e-9);
}

// What is left of readings that weigh 1e20 is rounding, which may be less than nothing: said, not looked for
// without end.
TEST(Evidence, WhereRoundingIsAllThatIsLeftIsSaid) {
  const Eigen::MatrixXd gram = -1e4 * Eigen::MatrixXd::Identity(2, 2);
  const Eigen::VectorXd score = Eigen::VectorXd::Constant(2, 3), sigma = Eigen::VectorXd::Ones(2);
  EXPECT_THROW(bestSizes(gram, score, sigma, {1, 1}), std::runtime_error);
  EXPECT_EQ(logBayesFactor(gram, score, sigma), -std::numeric_limits<double>::infinity());
  // What is no number is none either, although a square root does not say so.
  const Eigen::MatrixXd none = Eigen::MatrixXd::Constant(2, 2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(logBayesFactor(none, score, sigma), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace fathom
