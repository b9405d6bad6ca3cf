#include "estimation/wide_prior.h"

#include <cmath>

namespace fathom {

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
