#include "diagnosis/nominal.h"

#include <stdexcept>

#include "core/text.h"
#include "diagnosis/constants.h"
#include "diagnosis/shown_noise.h"

namespace fathom {

NominalFit nominalFit(const BatchData& data, const StartPath& start,
                      const EffectParameters<double>& calibration, const ErrorBudget& budget,
                      std::uint64_t seed) {
  NominalFit nominal;
  nominal.noise.budget = budget.of(pipelineOf(data.vehicle));
  const auto failed = [&](const std::string& why) {
    nominal.failure = why;
    return nominal;
  };
  nominal.options.calibration = calibration;
  nominal.options.cost_tolerance = kCostTolerance;
  BatchEstimate estimate = estimateBatch(data, start, nominal.options);
  try {
    for (int pass = 0; pass < kNoisePasses; ++pass) {
      if (pass > 0) estimate = minimumFrom(data, estimate, nominal.options);
      if (!estimate.succeeded) break;
      Linearization linear = linearize(data, *problemAt(data, estimate, nominal.options));
      applyRobustWeights(linear);
      nominal.noise = shownNoise(linear, nominal.noise, seed);
      nominal.noise.applyTo(nominal.options.problem);
    }
  } catch (const std::runtime_error& e) {
    return failed(print("The recording does not determine what the nominal model estimates (%s).", e.what()));
  }
  if (!estimate.succeeded) return failed("The nominal model could not be fitted: " + estimate.failure + ".");
  nominal.fit = refit(data, startingAt(estimate), nominal.options, {}, nominal.noise);
  if (!nominal.fit.succeeded)
    return failed("The nominal model could not be fitted: " + nominal.fit.estimate.failure + ".");
  return nominal;
}

}  // namespace fathom
