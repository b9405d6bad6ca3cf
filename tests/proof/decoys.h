#pragma once

#include <vector>

#include "planned_dive.h"

namespace fathom::proof {

/// An effect of a dive on which another one, which is absent, is tempting.
struct Decoy {
  Hidden hidden;
  ProofCase::Effect described;  ///< the runner-up: what tempts
};

/// All of that size, the hardest to tell from what tempts first. On a dive on which it comes nearer all the
/// while, where range and time say the same, what lasts is tempting for what has a time, and the other way
/// round.
std::vector<Decoy> decoysOn(const PlannedDive& dive, double sqrt_lambda, std::uint64_t seed);

}  // namespace fathom::proof
