#pragma once

#include <cmath>

namespace fathom {

/// A step of a first-order Gauss-Markov process of stationary sigma s, exact whatever the interval:
/// x' = decay x + innovation s w, w standard normal. The default is the process's start: nothing is kept of
/// before, and all of the stationary spread is new.
struct GaussMarkovStep {
  double decay = 0.0;

  GaussMarkovStep() = default;
  GaussMarkovStep(double interval_s, double time_constant_s)
      : decay(std::exp(-interval_s / time_constant_s)) {}
  double innovation() const { return std::sqrt(1.0 - decay * decay); }
};

/// Density of the white noise that drives the process, 1/s in units of s²: 2/tau, for those who integrate it.
inline double gaussMarkovDensity(double time_constant_s) { return 2.0 / time_constant_s; }

}  // namespace fathom
