#include "diagnosis/budget_learning.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/text.h"
#include "diagnosis/constants.h"

namespace fathom {
namespace {

/// Of a normal variable.
struct Normal {
  double mean = 0, variance = 1;
};

/// What a recording by itself says of ln sigma: its estimate without the prior that held it. Nothing where
/// its variance is infinite.
Normal toldBy(const EstimatedScale& scale, const Normal& prior) {
  const double variance = scale.log_sd * scale.log_sd;
  const double precision = 1 / variance - 1 / prior.variance;
  if (!(precision > 1e-9 / prior.variance)) return {prior.mean, std::numeric_limits<double>::infinity()};
  return {(std::log(scale.scale) / variance - prior.mean / prior.variance) / precision, 1 / precision};
}

VarianceComponent learnt(VarianceComponent component, const std::vector<EstimatedScale>& scales) {
  const Normal prior{std::log(component.sigma), std::pow(component.logSd(), 2)};
  const double between_vehicles = kBetweenVehicles * prior.variance,
               between_recordings = prior.variance - between_vehicles;
  double precision = 1 / between_vehicles, weighted = prior.mean / between_vehicles;
  for (const EstimatedScale& scale : scales) {
    const Normal told = toldBy(scale, prior);
    const double weight = 1 / (told.variance + between_recordings);
    precision += weight;
    weighted += weight * told.mean;
  }
  component.sigma = std::exp(weighted / precision);
  component.factor = std::exp(kSigmasOf99 * std::sqrt(1 / precision + between_recordings));
  component.processed.reset();  // learnt from what this vehicle's camera has
  return component;
}

}  // namespace

ErrorBudget learntBudget(const ErrorBudget& before,
                         const std::vector<std::vector<EstimatedScale>>& recordings) {
  ErrorBudget after = before;
  for (std::size_t k = 0; k < before.components.size(); ++k) {
    std::vector<EstimatedScale> scales;
    for (const std::vector<EstimatedScale>& recording : recordings) {
      if (recording.size() != before.components.size())
        throw std::invalid_argument("scales of another budget");
      scales.push_back(recording[k]);
    }
    after.components[k] = learnt(before.components[k], scales);
    after.components[k].source =
        print("learnt from %zu recordings, with sigma %.3g and factor %.3g before (%s)", recordings.size(),
              before.components[k].sigma, before.components[k].factor, before.components[k].source.c_str());
  }
  return after;
}

}  // namespace fathom
