#include "diagnosis/placebo.h"

#include <algorithm>

#include "diagnosis/constants.h"
#include "diagnosis/screening.h"

namespace fathom {

Placebo::Placebo(const WhitenedModel& model, const Eigen::MatrixXd& noise, int folds)
    : noise_(noise), trained_(static_cast<std::size_t>(folds)) {
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
  all_ = {model.nuisances().reduceEach(columns_, model.residual(), size_),
          model.nuisances().scores(columns_, noise_)};
}

void Placebo::take(int fold, const RowsAlone& train) {
  trained_[static_cast<std::size_t>(fold)] = {train.reduceEach(columns_, size_),
                                              train.scores(columns_, noise_)};
}

double Placebo::percentile95() const {
  if (trained_.empty()) return 0;
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
  return EffectEvidence(all_.each[candidate].gram, sigma_.segment(k, n))
      .best(all_.scores.col(draw).segment(k, n))
      .log_bayes_factor;
}

/// What all rows say of its value as trained, beyond those that it was trained on.
double Placebo::gainOf(std::size_t candidate, Eigen::Index draw) const {
  const Eigen::Index k = first_[candidate], n = size_[candidate];
  double gain = 0;
  for (const Seen& train : trained_) {
    const Eigen::VectorXd score = train.scores.col(draw).segment(k, n);
    const Eigen::VectorXd value = fitted(train.each[candidate].gram, score, sigma_.segment(k, n));
    const auto told = [&](const Eigen::MatrixXd& gram, const Eigen::VectorXd& its_score) {
      return -its_score.dot(value) - 0.5 * value.dot(gram * value);
    };
    gain += told(all_.each[candidate].gram, all_.scores.col(draw).segment(k, n)) -
            told(train.each[candidate].gram, score);
  }
  return gain;
}

}  // namespace fathom
