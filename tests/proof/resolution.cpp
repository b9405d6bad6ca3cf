#include "resolution.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "diagnosis/nominal.h"
#include "diagnosis/screening.h"
#include "effects/drawn.h"

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

std::vector<Candidate> candidatesFor(const EffectInfo& effect, const std::vector<int>& marker_ids,
                                     const Interval& span) {
  std::vector<Candidate> all;
  Candidate candidate;
  candidate.effect = effect.index;
  const auto addTenths = [&](const auto& at) {
    for (int k = 1; k < 10; ++k) {
      at(span.from_s + 0.1 * k * (span.to_s - span.from_s));
      all.push_back(candidate);
    }
  };
  if (effect.has(ParameterKind::marker_id))
    for (const int id : marker_ids) {
      candidate.marker_id = id;
      all.push_back(candidate);
    }
  else if (hasPeak(effect))
    addTenths([&](double t_s) { candidate.peak = Peak{t_s, 0.1 * (span.to_s - span.from_s)}; });
  else if (effect.has(ParameterKind::time))
    addTenths([&](double t_s) { candidate.time_s = t_s; });
  else
    all.push_back(candidate);
  return all;
}

}  // namespace

nlohmann::json parametersOf(const Hidden& hidden) {
  const EffectInfo& effect = allEffects()[hidden.candidate.effect];
  nlohmann::json json = nlohmann::json::object();
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& parameter : effect.parameters) {
    nlohmann::json values = nlohmann::json::array();
    for (int i = 0; i < parameter.size; ++i, ++scalar)
      values.push_back(asNamed(parameter, hidden.effects.values[scalar]));
    if (parameter.kind == ParameterKind::marker_id) values = {static_cast<int>(values[0].get<double>())};
    json[std::string(parameter.name)] = parameter.size == 1 ? values[0] : values;
  }
  return json;
}

Hidden scaled(const Hidden& hidden, double factor) {
  Hidden other = hidden;
  const EffectInfo& effect = allEffects()[hidden.candidate.effect];
  for (std::size_t s = effect.first_scalar; s < effect.first_scalar + effect.scalars; ++s)
    if (isSize(parameterOf(s).kind)) other.effects.values[s] *= factor;
  return other;
}

bool isWithinLimits(const Hidden& hidden) {
  const EffectInfo& effect = allEffects()[hidden.candidate.effect];
  for (std::size_t s = effect.first_scalar; s < effect.first_scalar + effect.scalars; ++s)
    if (std::abs(asNamed(parameterOf(s), hidden.effects.values[s])) > parameterOf(s).limit) return false;
  return true;
}

Resolution::Resolution(const BatchInput& null) {
  const NominalFit nominal = nominalFit(null.data, null.start, {}, 1);
  if (!nominal.failure.empty()) throw Error("a dive that hides nothing", "", nominal.failure);
  noise_ = nominal.noise;
  options_ = nominal.options;
  model_ = nominal.fit.model;
  span_ = {null.data.first_s, null.data.last_s};
  const std::set<int> ids = markersOf(model_->linear());
  marker_ids_.assign(ids.begin(), ids.end());
  for (const EffectInfo& effect : allEffects())
    if (canShow(effect.index))
      for (const Candidate& candidate : candidatesFor(effect, marker_ids_, span_))
        rivals_.push_back(candidate);
}

bool Resolution::canShow(std::size_t effect) const { return fathom::canShow(model_->linear(), effect); }

double Resolution::sqrtLambda(const Hidden& hidden) const {
  const Eigen::MatrixXd A = model_->reduce(std::vector<Candidate>{hidden.candidate}).gram;
  return std::sqrt(quadratic(hidden, valuesOf(hidden, model_->linear()), A));
}

std::vector<double> Resolution::alignments(const Hidden& hidden) const {
  std::vector<Candidate> all{hidden.candidate};
  all.insert(all.end(), rivals_.begin(), rivals_.end());
  const Reduced reduced = model_->reduce(all);
  const Eigen::VectorXd value = valuesOf(hidden, model_->linear());
  const auto own = std::ssize(columnsOf(model_->linear(), hidden.candidate.effect));
  const double whole = quadratic(hidden, value, reduced.gram.topLeftCorner(own, own));
  std::vector<double> alignments;
  Eigen::Index place = own;
  for (const Candidate& rival : rivals_) {
    const auto other = std::ssize(columnsOf(model_->linear(), rival.effect));
    const Eigen::MatrixXd B = reduced.gram.block(0, place, own, other);
    const Information information(reduced.gram.block(place, place, other, other),
                                  reduced.norms.segment(place, other));
    const double imitated = quadratic(hidden, value, B * information.inverse * B.transpose());
    alignments.push_back(whole > 0 ? std::sqrt(std::min(1.0, imitated / whole)) : 0);
    place += other;
  }
  return alignments;
}

Resolution::Shown Resolution::shownBy(const BatchInput& without_noise) const {
  const BatchEstimate estimate = estimateBatch(without_noise.data, without_noise.start, options_);
  if (!estimate.succeeded) throw Error("a dive without noise", "", estimate.failure);
  Linearization linear = linearize(without_noise.data, *problemAt(without_noise.data, estimate, options_));
  const WhitenedModel model(std::move(linear), noise_, without_noise.data);
  Shown shown;
  shown.lambda = model.nuisances().project(model.residual()).squaredNorm();
  double imitated = 0;
  for (const Candidate& rival : rivals_) {
    const Reduced reduced = model.reduce(std::vector<Candidate>{rival});
    const Information information(reduced.gram, reduced.norms);
    imitated = std::max(imitated, reduced.score.dot(information.inverse * reduced.score));
  }
  shown.left = std::max(0.0, shown.lambda - imitated);
  return shown;
}

}  // namespace fathom::proof
