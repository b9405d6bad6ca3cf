#pragma once

#include <limits>
#include <vector>

#include "diagnosis/screening.h"

namespace fathom {

/// Effects that are worth estimating in full.
struct Contender {
  std::vector<Candidate> effects;
  double foretold = std::numeric_limits<double>::max();  ///< ln of their odds, to first order, if that tells
};

/// Sets of up to `size` effects that are worth estimating in full: the likeliest to first order, and single
/// ones of which the first order tells little. `threshold`: ln of the odds that something found has to have;
/// `camera_alone`: without INS and DVL, where all that lasts is tried.
std::vector<Contender> contendersOf(const Screening& screening, std::size_t size, double threshold,
                                    bool camera_alone);

}  // namespace fathom
