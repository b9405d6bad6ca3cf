#pragma once

#include <string>

#include "diagnosis/refit.h"

namespace fathom {

/// The nominal model at its best, with the noise that the recording shows.
struct NominalFit {
  std::string failure;   ///< a sentence; empty: there is a fit
  BatchOptions options;  ///< with which it was made
  NoiseModel noise;
  Refit fit;
};

/// `calibration`: what is known already; of `budget` what the vehicle's camera has. The seed is of simulated
/// noise, see shownNoise().
NominalFit nominalFit(const BatchData& data, const StartPath& start,
                      const EffectParameters<double>& calibration, const ErrorBudget& budget,
                      std::uint64_t seed);

}  // namespace fathom
