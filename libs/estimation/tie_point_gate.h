#pragma once

#include "estimation/batch_data.h"

/// The one gate before the estimate: pairs that are none.
namespace fathom {

/// Two different things taken for one contradict each other by far more than any that is one: 8 sigmas of the
/// scatter that the tie points show about the place of the right camera that most agree on. Left out and
/// counted, like those whose lines of sight are parallel.
void leaveOutMismatches(BatchData& data);

}  // namespace fathom
