#include "diagnosis/placebo.h"

#include <algorithm>

#include "core/linear_algebra.h"
#include "diagnosis/constants.h"
#include "diagnosis/screening.h"

namespace fathom {

Placebo::Placebo(const WhitenedModel& model, const Eigen::MatrixXd& noise, int folds)
    : noise_(noise), folds_(static_cast<std::size_t>(folds)) {
  const Linearization& linear = model.linear();
  const std::vector<Candidate> candidates = lastingCandidates(linear);
  columns_ = model.whitened(columnsOf(linear, candidates));
  sigma_ = priorSigmas(linear, candidates);
  Eigen::Index first = 0;
  for (const Candidate& candidate : candidates) {
    first_.push_back(first);
    size_.push_back(std::ssize(columnsOf(linear, candidate.effect)));
    first += size_.back();
  }
}

void Placebo::take(int fold, const RowsAlone& train, const RowsAlone& test) {
  folds_[static_cast<std::size_t>(fold)] = {train.reduceEach(columns_, size_),
                                            test.reduceEach(columns_, size_), train.scores(columns_, noise_),
                                            test.scores(columns_, noise_)};
}

double Placebo::percentile95() const {
  if (folds_.empty()) return 0;
  std::vector<double> gains;
  for (Eigen::Index draw = 0; draw < kPlacebos; ++draw) {
    double best = -1e300, gain = 0;
    for (std::size_t c = 0; c < first_.size(); ++c) {
      const double own = evidenceOf(c, draw);
      if (own <= best) continue;
      best = own;
      gain = gainOf(c, draw);
    }
    gains.push_back(gain);
  }
  std::sort(gains.begin(), gains.end());
  return gains[gains.size() * 95 / 100];
}

double Placebo::evidenceOf(std::size_t candidate, Eigen::Index draw) const {
  const Eigen::Index k = first_[candidate], n = size_[candidate];
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
  for (const Fold& fold : folds_) {
    A += fold.test[candidate].gram;
    g += fold.g_test.col(draw).segment(k, n);
  }
  return EffectEvidence(A, sigma_.segment(k, n)).best(g).log_bayes_factor;
}

double Placebo::gainOf(std::size_t candidate, Eigen::Index draw) const {
  const Eigen::Index k = first_[candidate], n = size_[candidate];
  double gain = 0;
  for (const Fold& fold : folds_) {
    Eigen::MatrixXd A = fold.train[candidate].gram;
    A.diagonal() += sigma_.segment(k, n).array().square().inverse().matrix();
    const Eigen::VectorXd value = -solveSymmetric(A, fold.g_train.col(draw).segment(k, n));
    gain -=
        fold.g_test.col(draw).segment(k, n).dot(value) + 0.5 * value.dot(fold.test[candidate].gram * value);
  }
  return gain;
}

}  // namespace fathom
