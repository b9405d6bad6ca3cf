#include "estimation/wide_prior.h"

#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"

namespace fathom {

bool hasWidePrior(std::size_t effect) {
  const auto& parameters = allEffects()[effect].parameters;
  return std::count_if(parameters.begin(), parameters.end(),
                       [](const Parameter& parameter) { return isDifferentiated(parameter.kind); }) == 1;
}

double widePriorWeight(double square, double dimensions) {
  return square <= dimensions ? 1 : (dimensions + 1) / (1 + square);
}

double widePriorCost(double square, double dimensions) {
  if (square <= dimensions) return 0.5 * square;
  return 0.5 * dimensions + 0.5 * (dimensions + 1) * std::log((1 + square) / (1 + dimensions));
}

void WidePriorLoss::Evaluate(double square, double rho[3]) const {
  rho[0] = 2 * widePriorCost(square, dimensions_);
  rho[1] = widePriorWeight(square, dimensions_);
  rho[2] = square <= dimensions_ ? 0 : -rho[1] / (1 + square);
}

}  // namespace fathom
