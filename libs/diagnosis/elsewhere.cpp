#include "diagnosis/elsewhere.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/stable_sort.h"
#include "diagnosis/refit.h"
#include "diagnosis/residual_metrics.h"
#include "diagnosis/rows_alone.h"
#include "effects/drawn.h"

namespace fathom {
namespace {

BatchOptions optionsWith(const Diagnosis& diagnosis) {
  BatchOptions options = diagnosis.before_options;
  for (const Candidate& effect : lastingEffects(diagnosis)) {
    switchOn(options.calibration, effect);
    for (const std::size_t s : continuousScalars(effect.effect))
      options.calibration.values[s] = diagnosis.after.state.effects.values[s];
  }
  return options;
}

/// The nominal model where the effects were found. Throws Error.
Refit nominalOf(const Diagnosis& diagnosis, const BatchInput& recording) {
  Refit nominal =
      refit(recording.data, startingAt(diagnosis.before), diagnosis.before_options, {}, diagnosis.noise);
  if (!nominal.succeeded)
    throw Error("--judge", "", "the nominal model could not be fitted again: " + nominal.estimate.failure);
  return nominal;
}

/// The channel that the effects change most.
Channel mostChanged(const Diagnosis& diagnosis, const WhitenedModel& nominal) {
  const Linearization& linear = nominal.linear();
  const std::vector<Candidate> effects = lastingEffects(diagnosis);
  std::vector<double> values;
  for (const Candidate& effect : effects)
    for (const std::size_t s : continuousScalars(effect.effect))
      values.push_back(diagnosis.after.state.effects.values[s]);
  const Eigen::Map<const Eigen::VectorXd> sizes(values.data(), std::ssize(values));
  return channelsOf(nominal, nominal.whitened(columnsOf(linear, effects)) * sizes).front();
}

/// Outliers too.
double rmsOf(const Eigen::VectorXd& left, const Linearization& linear, Channel channel) {
  double square = 0, rows = 0;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == channel) {
      square += std::pow(left[static_cast<Eigen::Index>(i)], 2) / linear.rows[i].robust_weight;
      ++rows;
    }
  return rows > 0 ? std::sqrt(square / rows) : 0;
}

}  // namespace

std::vector<Candidate> lastingEffects(const Diagnosis& diagnosis) {
  std::vector<Candidate> lasting;
  for (const FoundEffect& found : diagnosis.effects)
    // What was drawn for an image was drawn for that one only.
    if (found.candidate.isForGood() && !isDrawn(found.candidate.effect)) lasting.push_back(found.candidate);
  return lasting;
}

JudgeElsewhere::JudgeElsewhere(const Diagnosis& diagnosis, const BatchInput& recording)
    : JudgeElsewhere(diagnosis, *nominalOf(diagnosis, recording).model) {}

JudgeElsewhere::JudgeElsewhere(const Diagnosis& diagnosis, const WhitenedModel& nominal)
    : noise_(diagnosis.noise),
      nominal_(diagnosis.before_options),
      with_(optionsWith(diagnosis)),
      black_box_(nominal.linear(), mostChanged(diagnosis, nominal)) {
  const Reduced reduced = nominal.reduce(black_box_.columns(nominal.linear()));
  splines_ = fitted(reduced.gram, reduced.score, black_box_.priorSigma());
}

Elsewhere JudgeElsewhere::judge(const BatchInput& other) const {
  Elsewhere result;
  const BatchEstimate start = estimateBatch(other.data, other.start, nominal_);
  const Refit before = start.succeeded ? refit(other.data, startingAt(start), nominal_, {}, noise_) : Refit{};
  const Refit after = before.succeeded ? refit(other.data, before, with_, {}, noise_) : Refit{};
  if (!after.succeeded) {
    result.failure = !start.succeeded    ? start.failure
                     : !before.succeeded ? before.estimate.failure
                                         : after.estimate.failure;
    return result;
  }
  const WhitenedModel &model = *before.model, &with = *after.model;
  const Eigen::VectorXd left = model.nuisances().project(model.residual());
  const Eigen::VectorXd left_with = with.nuisances().project(with.residual());
  const Eigen::VectorXd boxed = model.nuisances().project(
      model.residual() + model.whitened(black_box_.columns(model.linear())) * splines_);
  result.physics = after.weight.log_evidence - before.weight.log_evidence;
  result.black_box = model.costOf(left) - model.costOf(boxed);
  for (const Channel channel : kEveryChannel) {
    const double was = rmsOf(left, model.linear(), channel);
    if (channel == kChannel<Prior> || was == 0) continue;
    const double is = rmsOf(left_with, with.linear(), channel),
                 unit = printedUnit(with.linear(), noise_, channel);
    result.channels.push_back({channel, std::string(textOf(channel).metric), unit * was, unit * is,
                               unit * rmsOf(boxed, model.linear(), channel), was - is});
  }
  stableSort(result.channels, [](const ElsewhereChannel& a, const ElsewhereChannel& b) {
    return std::abs(a.less) > std::abs(b.less);
  });
  return result;
}

}  // namespace fathom
