#pragma once

#include <optional>
#include <string>
#include <vector>

#include "estimation/linearization.h"

namespace fathom {

/// An effect that may be missing: of a registered effect, what a fit cannot differentiate by.
struct Candidate {
  std::size_t effect = 0;        ///< in the registry
  std::optional<int> marker_id;  ///< where the effect has one
  std::optional<double> time_s;  ///< of a step, where the effect has one
  Interval active_s;             ///< forever: not an interval

  bool isForGood() const { return active_s == Interval{}; }
  friend bool operator==(const Candidate&, const Candidate&) = default;
};

/// "marker-moved 14", "panel-moved at 73.2 s", "water-current from 30.0 to 80.0 s".
std::string nameOf(const Candidate& candidate);

/// Sets the effect on in a calibration, at neutral where it is not on yet.
void switchOn(EffectParameters<double>& calibration, const Candidate& candidate);

/// Whether a row feels the candidate.
bool feels(const RowInfo& row, const Candidate& candidate);

}  // namespace fathom
