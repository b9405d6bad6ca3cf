#pragma once

#include <cstdint>

#include "diagnosis/budget_file.h"
#include "diagnosis/held_out.h"
#include "diagnosis/result.h"

/// Which physics a recording shows that its model leaves out: locate, attribute, model, verify.
namespace fathom {

struct DiagnosisOptions {
  EffectParameters<double> calibration;  ///< what is known already
  ErrorBudget budget = fieldBudget();
  /// What would be named under this one, and is within what the other allows for, is a remark.
  ErrorBudget tight_budget = laboratoryBudget();
  double false_alarm = 0.01;  ///< of a recording with nothing missing
  std::size_t max_effects = 8;
  int segments = 30;  ///< onsets and ends are looked for at so many places first
  HeldOutOptions heldout;
  std::uint64_t seed = 1;  ///< of the simulated noise
};

/// The same result whatever the number of threads. Throws Interrupted.
Diagnosis diagnose(const BatchInput& input, const DiagnosisOptions& options = {});

}  // namespace fathom
