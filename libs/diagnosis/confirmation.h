#pragma once

#include <string>
#include <vector>

#include "diagnosis/fits.h"
#include "diagnosis/held_out.h"

/// Is what fits to be named?
namespace fathom {

/// Whether what one effect is wrong by would show in readings of the other's kind. Corners are found in the
/// light of the images: what comes and goes in them may be an error of that.
bool mayErrAs(const Candidate& larger, const Candidate& effect);

/// How a fit does where it was not fitted.
HeldOutResult heldOut(const Fits& fits, const Refit& fit, const HeldOutOptions& options);

/// Of a gain that is expected where an effect was not fitted, what has to be seen: so large a share as models
/// are exact (kConfirmed), less what a true effect may miss by chance (scatter: HeldOutGain's), and something
/// in any case: one that is not there loses as much as is expected.
double leastSeen(double expected, double scatter);

/// By what effects are confirmed, and where it is noted which are not.
struct Confirmation {
  Fits& fits;
  HeldOutOptions held_out;
  LeftOut& left_out;
  std::vector<std::string>& remarks;
};

/// What is left of a fit when those effects have gone that do not show on stretches that they were not fitted
/// to, or that may be a larger one's error, and then what was needed beside them only. Effects that are there
/// `already` are not looked at again where nothing else is.
Refit confirmed(Refit fit, const std::vector<Candidate>& already, const Confirmation& by);

}  // namespace fathom
