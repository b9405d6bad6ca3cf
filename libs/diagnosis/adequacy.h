#pragma once

#include <string>
#include <vector>

#include "diagnosis/refit.h"

namespace fathom {

/// Whether an effect is the same all over the recording.
struct InteractionTest {
  std::string against;         ///< "time", "speed", …
  double statistic = 0;        ///< chi-square of 1 where it is the same
  double log_p = 0;            ///< having looked at all covariates
  double relative_change = 0;  ///< of the effect over one standard deviation of the covariate
  bool failed = false;         ///< too improbable, and too large to be its model's curvature
};

/// The effect's own share of the readings, larger or smaller with each covariate in turn: what is left of
/// such a change once all else is estimated. An effect that is none of the catalogue's seldom passes.
std::vector<InteractionTest> interactionTests(const Refit& fit, const Candidate& effect);
bool hasFailed(const std::vector<InteractionTest>& tests);

}  // namespace fathom
