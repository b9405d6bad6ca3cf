#include "diagnosis/refit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/linear_algebra.h"
#include "diagnosis/constants.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

/// Nothing clearly less than nothing, nor more than a calibration may hold: so far off, an effect makes
/// outliers fit.
bool areAllPossible(const Refit& fit) {
  return std::all_of(fit.estimates.begin(), fit.estimates.end(), [](const EffectEstimate& estimate) {
    const Parameter& parameter = parameterOf(estimate.scalar);
    return canBeFound(estimate.scalar, estimate.value, estimate.sigma) &&
           (!isSize(parameter.kind) || std::abs(asNamed(parameter, estimate.value)) <= parameter.limit);
  });
}

/// What would be less than nothing, though not clearly, is nothing, and all others what they are then.
void holdAtNothing(Refit& fit) {
  std::vector<Eigen::Index> below;
  for (std::size_t i = 0; i < fit.estimates.size(); ++i) {
    const EffectEstimate& found = fit.estimates[i];
    if (found.image < 0 && !isPossible(parameterOf(found.scalar), found.value))
      below.push_back(static_cast<Eigen::Index>(i));
  }
  if (below.empty()) return;
  Eigen::VectorXd excess(std::ssize(below));
  for (Eigen::Index k = 0; k < excess.size(); ++k)
    excess[k] = fit.estimates[static_cast<std::size_t>(below[static_cast<std::size_t>(k)])].value;
  const Eigen::VectorXd change = -fit.covariance(Eigen::all, below) *
                                 solveSymmetric(Eigen::MatrixXd(fit.covariance(below, below)), excess);
  for (std::size_t i = 0; i < fit.estimates.size(); ++i)
    fit.estimates[i].value += change[static_cast<Eigen::Index>(i)];
  for (const Eigen::Index i : below) fit.estimates[static_cast<std::size_t>(i)].value = 0;
  for (EffectEstimate& found : fit.estimates)
    if (found.image < 0 && !isPossible(parameterOf(found.scalar), found.value)) found.value = 0;
}

/// The effects as they are with the noise as it is: readings of a sensor have some of it in common, which the
/// estimate did not know.
void noteEstimates(Refit& fit, const Linearization& linear, const Eigen::VectorXd& value) {
  const Evidence& found = fit.weight.effects;
  const EffectParameters<double>& at = fit.linearized_at.effects;
  fit.estimates.clear();
  for (const Candidate& candidate : fit.effects)
    for (const CandidateColumn& own : columnsOf(linear, candidate.effect)) {
      const auto k = std::ssize(fit.estimates);
      const std::size_t scalar = linear.columns[own.column].scalar;
      const double from = own.image >= 0 ? 0 : at.values[scalar] - sizeOf(scalar, at.values[scalar]);
      fit.estimates.push_back(
          {candidate.effect, scalar, from + value[k], std::sqrt(found.covariance(k, k)), own.image});
    }
  fit.covariance = found.covariance;
  fit.prior_sigma = priorSigmas(linear, fit.effects);
}

/// See sqrtLambda().
double lambdaOf(const Refit& fit, const std::vector<Eigen::Index>& estimates) {
  const auto size = std::ssize(estimates);
  Eigen::VectorXd value(size), precision(size);
  for (Eigen::Index a = 0; a < size; ++a) {
    const Eigen::Index i = estimates[static_cast<std::size_t>(a)];
    const EffectEstimate& estimate = fit.estimates[static_cast<std::size_t>(i)];
    value[a] = sizeOf(estimate.scalar, estimate.value);
    precision[a] = 1 / (fit.prior_sigma[i] * fit.prior_sigma[i]);
  }
  const Eigen::MatrixXd covariance = fit.covariance(estimates, estimates);
  const Eigen::MatrixXd information = inverseOf(covariance) - Eigen::MatrixXd(precision.asDiagonal());
  return std::max(0.0, value.dot(information * value));
}

void takeEstimates(const Refit& fit, BatchState& state) {
  const EffectParameters<double> before = state.effects;
  for (const EffectEstimate& found : fit.estimates)
    if (found.image < 0)
      state.effects.values[found.scalar] = found.value;
    else
      state.draws[{found.scalar, static_cast<std::size_t>(found.image)}] = found.value;
  moveKnots(before, state);
}

std::vector<PatchLight> lightOf(const BatchData& data, const Linearization& linear, const Weight& weight) {
  std::vector<PatchLight> light(data.patches.size());
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    if (row.patch < 0) continue;
    PatchLight& own = light[static_cast<std::size_t>(row.patch)];
    own.reflected[row.component] = weight.reflected[static_cast<Eigen::Index>(i)];
    own.level[row.component] = weight.level[static_cast<Eigen::Index>(i)];
    own.moved[row.component] = weight.moved[static_cast<Eigen::Index>(i)];
  }
  return light;
}

/// Where budget and effects have everything, as they were weighed there.
BatchState movedBy(Refit& fit, const BatchProblem& problem, const Linearization& linear,
                   const BatchData& data) {
  noteEstimates(fit, linear, fit.weight.values);
  holdAtNothing(fit);
  BatchState state = problem.at(fit.weight.step);
  takeEstimates(fit, state);
  state.light = lightOf(data, linear, fit.weight);
  return state;
}

/// What is further off is no imperfection, and a line through nominal light leads nowhere.
bool isNear(const Weight& weight) {
  return std::max(weight.level.cwiseAbs().maxCoeff(), weight.reflected.cwiseAbs().maxCoeff()) < kMostLight;
}

/// Whether readings at a state are, but for what they resolve together, what was linear about another one
/// said they would be there.
bool isAsForetold(const Linearization& there, const Linearization& linear, const Eigen::VectorXd& foretold) {
  double off = 0;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    if (linear.rows[i].patch < 0) continue;
    const auto k = static_cast<Eigen::Index>(i);
    off += std::pow(there.residual[k] * std::sqrt(linear.rows[i].robust_weight) - foretold[k], 2);
  }
  return off < kAsForetold;
}

/// Takes the same readings' weights for what they were elsewhere.
void takeWeights(Linearization& linear, const std::vector<double>& weights) {
  for (std::size_t i = 0; i < linear.rows.size(); ++i) linear.rows[i].robust_weight = weights[i];
}

std::vector<double> weightsOf(const Linearization& linear) {
  std::vector<double> weights;
  for (const RowInfo& row : linear.rows) weights.push_back(row.robust_weight);
  return weights;
}

/// Weighs a fit, light being linearized where budget and effects have it: what several imperfections make of
/// light is their product, and what is linear about nominal light knows their sum only.
void weigh(Refit& fit, const BatchData& data, const Refit& from, const NoiseModel& noise,
           Linearization& linear, HeldColumns& budget) {
  BatchEstimate at = fit.estimate;
  at.state.light = from.linearized_at.light;
  auto problem = problemAt(data, at, fit.options);
  linear = linearize(data, *problem);
  fit.noise = noise;
  // Judged anew beside these effects: what they explain of a place is no growth there.
  fit.noise.apart.clear();
  for (int round = 1;; ++round) {
    applyRobustWeights(linear);
    budget = budgetColumns(linear, fit.noise);
    fit.weight = weigh(linear, budget, fit.effects, at.state, fit.noise);
    fit.noise.apart = fit.weight.apart;
    fit.linearized_at = at.state;
    fit.robust_weights = weightsOf(linear);
    if (data.patches.empty() || round == kLinearized || !isNear(fit.weight)) return;
    at.state = movedBy(fit, *problem, linear, data);
    problem = problemAt(data, at, fit.options);
    Linearization there = linearize(data, *problem);
    if (isAsForetold(there, linear, fit.weight.left)) return;
    takeWeights(there, fit.robust_weights);
    linear = std::move(there);
  }
}

void finish(Refit& fit, const Linearization& linear) {
  noteEstimates(fit, linear, fit.weight.effects.value);
  fit.succeeded = areAllPossible(fit);
  if (!fit.succeeded) {
    fit.estimate.failure = "less than nothing of an effect would have to be there, or more than there can be";
    return;
  }
  holdAtNothing(fit);
  BatchState& state = fit.estimate.state;
  takeEstimates(fit, state);
  for (const EffectEstimate& spread : withSpreads(fit)) state.effects.values[spread.scalar] = spread.value;
}

}  // namespace

Refit startingAt(BatchEstimate estimate) {
  Refit start;
  start.estimate = std::move(estimate);
  return start;
}

Refit refit(const BatchData& data, const Refit& from, const BatchOptions& base,
            const std::vector<Candidate>& effects, const NoiseModel& noise, Model model) {
  Refit fit;
  fit.effects = effects;
  fit.options = base;
  noise.applyTo(fit.options.problem);
  for (const Candidate& effect : effects) {
    switchOn(fit.options.calibration, effect);
    fit.options.problem.estimate.set(effect.effect);
  }
  fit.estimate = bestMinimumFrom(data, from.estimate, fit.options);
  if (!fit.estimate.succeeded) return fit;
  try {
    Linearization linear;
    HeldColumns budget;
    weigh(fit, data, from, noise, linear, budget);
    fit.noise.scales = fit.weight.scales;
    finish(fit, linear);
    if (model == Model::kept)
      fit.model =
          std::make_shared<WhitenedModel>(WhitenedModel::Weighted{}, std::move(linear), fit.noise, budget);
  } catch (const std::runtime_error& e) {
    fit.succeeded = false;
    fit.estimate.failure = e.what();
  }
  return fit;
}

std::shared_ptr<const WhitenedModel> modelOf(const BatchData& data, const Refit& fit) {
  if (fit.model) return fit.model;
  BatchEstimate estimate = fit.estimate;
  estimate.state = fit.linearized_at;
  Linearization linear = linearize(data, *problemAt(data, estimate, fit.options));
  takeWeights(linear, fit.robust_weights);
  applyRobustWeights(linear);
  return std::make_shared<WhitenedModel>(WhitenedModel::Weighted{}, std::move(linear), fit.noise);
}

std::vector<EffectEstimate> withSpreads(const Refit& fit) {
  std::vector<EffectEstimate> all;
  std::vector<Eigen::Index> drawn;
  std::vector<std::size_t> scalars;
  std::vector<double> values;
  for (std::size_t i = 0; i < fit.estimates.size(); ++i) {
    const EffectEstimate& estimate = fit.estimates[i];
    if (estimate.image < 0) {
      all.push_back(estimate);
      continue;
    }
    drawn.push_back(static_cast<Eigen::Index>(i));
    scalars.push_back(estimate.scalar);
    values.push_back(estimate.value);
  }
  const Eigen::Map<const Eigen::VectorXd> value(values.data(), std::ssize(values));
  const auto spreads = spreadsOf(scalars, value, fit.covariance(drawn, drawn));
  all.insert(all.end(), spreads.begin(), spreads.end());
  return all;
}

Eigen::VectorXd changeBy(const Refit& fit, const Candidate& effect, const Linearization& at) {
  const Eigen::SparseMatrix<double> own = columnsOf(at, {effect});
  Eigen::VectorXd value(own.cols());
  Eigen::Index k = 0;
  for (const EffectEstimate& estimate : fit.estimates)
    if (estimate.effect == effect.effect) value[k++] = sizeOf(estimate.scalar, estimate.value);
  return own * value;
}

double sqrtLambda(const Refit& fit, std::size_t effect) {
  std::vector<Eigen::Index> own;
  for (std::size_t i = 0; i < fit.estimates.size(); ++i)
    if (fit.estimates[i].effect == effect) own.push_back(static_cast<Eigen::Index>(i));
  return std::sqrt(lambdaOf(fit, own));
}

}  // namespace fathom
