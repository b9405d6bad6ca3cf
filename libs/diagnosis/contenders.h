#pragma once

#include <vector>

#include "diagnosis/screening.h"

namespace fathom {

/// Sets of up to `size` effects that are worth estimating in full: the likeliest to first order, and single
/// ones of which the first order tells little. `threshold`: ln of the odds that something found has to have;
/// `camera_alone`: without INS and DVL, where all that lasts is tried.
std::vector<std::vector<Candidate>> contendersOf(const Screening& screening, std::size_t size,
                                                 double threshold, bool camera_alone);

}  // namespace fathom
