#pragma once

#include <memory>
#include <vector>

#include "diagnosis/whitened_model.h"
#include "estimation/batch_estimate.h"

namespace fathom {

/// The whole estimate with certain effects among the unknowns, and what it is worth.
struct Refit {
  std::vector<Candidate> effects;
  bool succeeded = false;
  BatchOptions options;
  BatchEstimate estimate;
  std::shared_ptr<const WhitenedModel> model;  ///< at the estimate
  std::vector<EffectEstimate> estimates;       ///< of the effects, for the noise as it is
  Eigen::MatrixXd covariance;                  ///< of `estimates`
  /// Half the sum of squares, with robust loss, and the priors; effects' priors with long tails.
  double cost = 0;
  double freedom = 0;  ///< parameters of the effects that the readings determine, not their priors
};

/// Everything estimated from where another fit ended; `base`: with the effects known already.
Refit refit(const BatchData& data, const BatchEstimate& from, const BatchOptions& base,
            const std::vector<Candidate>& effects, const NoiseModel& noise);

/// A fit's estimates with those of what was drawn for each image replaced by one of their spread: what they
/// scatter by about their mean, beyond their own sigmas.
std::vector<EffectEstimate> withSpreads(const Refit& fit);

/// -ln of the probability that a fit's likelihood exceeds that of one with fewer effects so much by chance.
double supportOver(const Refit& fit, const Refit& fewer);

/// What an effect, as large as the fit found it, changes in the readings at a linearization: over its rows,
/// in units of each reading's sigma.
Eigen::VectorXd changeBy(const Refit& fit, const Candidate& effect, const Linearization& at);

/// Whether a change of the readings, over the model's rows in units of each reading's sigma, is mostly told
/// by kinds of reading that it moves by more than they can be off for no reason of their own, however often
/// they are taken (ChannelText::systematic): by what remains of it once all that the model estimates has made
/// up for it, root mean square over the readings that it changes, or, of kinds that only those estimates
/// change, over all.
bool isBeyondBias(const WhitenedModel& model, const Eigen::VectorXd& change);

/// The same of an effect as large as the fit found it; the model: of `fewer`, the fit without it.
bool isBeyondBias(const Refit& fit, const Refit& fewer, const Candidate& effect);

/// Sizes of each effect in units of what the recording can resolve: sqrt(value^T information value).
double sqrtLambda(const Refit& fit, std::size_t effect);

}  // namespace fathom
