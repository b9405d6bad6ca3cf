#pragma once

#include <memory>
#include <vector>

#include "diagnosis/weight.h"
#include "diagnosis/whitened_model.h"
#include "estimation/batch_estimate.h"

namespace fathom {

/// The whole estimate with certain effects among the unknowns, and what it is worth.
struct Refit {
  std::vector<Candidate> effects;
  bool succeeded = false;
  BatchOptions options;
  BatchEstimate estimate;
  Weight weight;                          ///< what it is worth
  NoiseModel noise;                       ///< with the scales of the budget that it was weighed with
  std::vector<EffectEstimate> estimates;  ///< of the effects, for the noise as it is
  Eigen::VectorXd prior_sigma;            ///< of `estimates`
  Eigen::MatrixXd covariance;             ///< of `estimates`

  /// The readings' derivatives, which are most of what a fit holds: empty where they were let go.
  std::shared_ptr<const WhitenedModel> model;
  /// What it takes to make them again: where they were taken, and what each reading counts there.
  BatchState linearized_at;
  std::vector<double> robust_weights;
};

/// A fit's model: its own, or made again where that was let go.
std::shared_ptr<const WhitenedModel> modelOf(const BatchData& data, const Refit& fit);

/// Whether a fit's model, which takes half as long as the fit, is wanted.
enum class Model { kept, none };
/// What is known of a fit where only its estimate is.
Refit startingAt(BatchEstimate estimate);
/// Everything estimated from where another fit of the same readings ended, of which light is taken to begin
/// with; `base`: with the effects known already.
Refit refit(const BatchData& data, const Refit& from, const BatchOptions& base,
            const std::vector<Candidate>& effects, const NoiseModel& noise, Model model = Model::kept);

/// A fit's estimates with those of what was drawn for each image replaced by one of their spread: what they
/// scatter by about their mean, beyond their own sigmas.
std::vector<EffectEstimate> withSpreads(const Refit& fit);

/// What an effect, as large as the fit found it, changes in the readings at a linearization: over its rows,
/// in units of each reading's sigma.
Eigen::VectorXd changeBy(const Refit& fit, const Candidate& effect, const Linearization& at);

/// Size of one effect in units of what the recording can resolve: sqrt(value^T information value).
double sqrtLambda(const Refit& fit, std::size_t effect);

}  // namespace fathom
