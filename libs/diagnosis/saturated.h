#pragma once

#include <memory>

#include "diagnosis/candidate.h"
#include "diagnosis/noise.h"
#include "estimation/nuisances.h"

namespace fathom {

/// An estimate with every effect of the catalogue among its unknowns, each held by its prior, and every
/// component of the error budget, held as declared. What is then left is noise, or nothing that is known.
struct Saturated {
  std::vector<Candidate> candidates;
  Nuisances nuisances;             ///< unknowns of the linearization, the budget's columns, candidates'
  Eigen::VectorXd residual, left;  ///< before and after

  Saturated(const Linearization& linear, const NoiseModel& noise);
};

/// `linear` is weighted otherwise by then: what an effect explains is no outlier, a reading of light counts
/// in full where it does once all may be there. Else an effect that shows in all images would make light's
/// noise seem small. (Where corners are off by pixels, what explains them is far from linear, and which are
/// outliers is not known.)
std::unique_ptr<Saturated> saturate(Linearization& linear, const NoiseModel& noise);

}  // namespace fathom
