#include "resolution.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "diagnosis/allowance.h"
#include "diagnosis/budget_file.h"
#include "diagnosis/nominal.h"
#include "diagnosis/screening.h"
#include "effects/drawn.h"
#include "imaging/exposure_time.h"

namespace fathom::proof {
namespace {

/// A candidate's columns' values.
Eigen::VectorXd valuesOf(const Hidden& hidden, const Linearization& linear) {
  std::vector<double> values;
  for (const CandidateColumn& column : columnsOf(linear, hidden.candidate.effect)) {
    const std::size_t scalar = linear.columns[column.column].scalar;
    values.push_back(sizeOf(scalar, hidden.effects.values[scalar]));
  }
  return Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values));
}

/// value^T M value; of what is drawn for each image, on average over draws.
double quadratic(const Hidden& hidden, const Eigen::VectorXd& value, const Eigen::MatrixXd& M) {
  if (!isDrawn(hidden.candidate.effect)) return std::max(0.0, value.dot(M * value));
  return value.size() > 0 ? value[0] * value[0] * M.trace() : 0;
}

/// `rivals` of another effect than the hidden one, and those that last while that is on too.
std::vector<Candidate> rivalsAmong(const std::vector<Candidate>& candidates, const Candidate& hidden) {
  std::vector<Candidate> rivals;
  for (Candidate candidate : candidates) {
    if (candidate.effect == hidden.effect) continue;
    rivals.push_back(candidate);
    if (hidden.active_s == Interval{} || !candidate.isForGood()) continue;
    candidate.active_s = hidden.active_s;
    rivals.push_back(candidate);
  }
  return rivals;
}

}  // namespace

Resolution::Resolution(const BatchInput& null) {
  const NominalFit nominal = nominalFit(null.data, null.start, {}, fieldBudget(), 1);
  if (!nominal.failure.empty()) throw Error("a dive that hides nothing", "", nominal.failure);
  // By the budget as it is declared: how little of it this one recording shows is no measure.
  noise_ = nominal.noise.declared();
  options_ = nominal.options;
  model_ = std::shared_ptr<const WhitenedModel>(new WhitenedModel(nominal.fit.model->under(noise_)));
  exposure_s_ = statedExposure_s(null.data.vehicle);
  span_ = {null.data.first_s, null.data.last_s};
  const std::set<int> ids = markersOf(model_->linear());
  marker_ids_.assign(ids.begin(), ids.end());
  for (const EffectInfo& effect : allEffects())
    if (canShow(effect.index))
      for (const Candidate& candidate : test::candidatesOf(effect, marker_ids_, span_))
        candidates_.push_back(candidate);
}

bool Resolution::canShow(std::size_t effect) const { return fathom::canShow(model_->linear(), effect); }

double Resolution::sqrtLambda(const Hidden& hidden) const {
  Eigen::MatrixXd A = model_->reduce(std::vector<Candidate>{hidden.candidate}).gram;
  if (comesAndGoes(hidden.candidate))
    A = newsOf(A, allowancesOf(*model_, {lasting(hidden.candidate)}).front()) * A;
  return std::sqrt(quadratic(hidden, valuesOf(hidden, model_->linear()), A));
}

std::vector<Rival> Resolution::rivalsOf(const Hidden& hidden) const {
  const std::vector<Candidate> rivals = rivalsAmong(candidates_, hidden.candidate);
  std::vector<Candidate> all{hidden.candidate};
  all.insert(all.end(), rivals.begin(), rivals.end());
  const Reduced reduced = model_->reduce(all);
  const Eigen::VectorXd sigmas = priorSigmas(model_->linear(), all);
  const Eigen::VectorXd value = valuesOf(hidden, model_->linear());
  const auto own = std::ssize(columnsOf(model_->linear(), hidden.candidate.effect));
  const double whole = quadratic(hidden, value, reduced.gram.topLeftCorner(own, own));
  std::vector<Rival> described;
  Eigen::Index place = own;
  for (const Candidate& candidate : rivals) {
    const auto other = std::ssize(columnsOf(model_->linear(), candidate.effect));
    const Eigen::MatrixXd B = reduced.gram.block(0, place, own, other);
    const Information information(reduced.gram.block(place, place, other, other),
                                  reduced.norms.segment(place, other));
    const double imitated = quadratic(hidden, value, B * information.inverse * B.transpose());
    Rival rival{candidate, whole > 0 ? std::sqrt(std::min(1.0, imitated / whole)) : 0, 0};
    if (!isDrawn(hidden.candidate.effect) && !isDrawn(candidate.effect))
      rival.prior_sigmas = (information.inverse * B.transpose() * value)
                               .cwiseQuotient(sigmas.segment(place, other))
                               .lpNorm<Eigen::Infinity>();
    described.push_back(rival);
    place += other;
  }
  return described;
}

Resolution::Shown Resolution::shownBy(const BatchInput& without_noise) const {
  const BatchEstimate estimate = estimateBatch(without_noise.data, without_noise.start, options_);
  if (!estimate.succeeded) throw Error("a dive without noise", "", estimate.failure);
  Linearization linear = linearize(without_noise.data, *problemAt(without_noise.data, estimate, options_));
  const WhitenedModel model(std::move(linear), noise_);
  Shown shown;
  shown.lambda = model.nuisances().project(model.residual()).squaredNorm();
  double imitated = 0;
  for (const Candidate& rival : candidates_) {
    const Reduced reduced = model.reduce(std::vector<Candidate>{rival});
    const Information information(reduced.gram, reduced.norms);
    imitated = std::max(imitated, reduced.score.dot(information.inverse * reduced.score));
  }
  shown.left = std::max(0.0, shown.lambda - imitated);
  return shown;
}

}  // namespace fathom::proof
