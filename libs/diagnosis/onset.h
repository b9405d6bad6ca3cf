#pragma once

#include "diagnosis/whitened_model.h"

namespace fathom {

/// ln of the Bayes factor of each by itself, to first order. `model`: without any of them.
std::vector<double> evidencesOf(const WhitenedModel& model, const std::vector<Candidate>& candidates);

/// The candidate with the beginning, end or step time that the readings speak for most, to a fraction of
/// `step_s`: a search from its own times in steps that are halved. `model`: without the effect.
Candidate refinedInterval(const WhitenedModel& model, Candidate candidate, double step_s);

/// Whether, and from when to when, an effect that counts as lasting was on for a part of the recording only:
/// the best of all intervals between `segments` equal parts, by evidence; itself where none is better.
Candidate bestInterval(const WhitenedModel& model, const Candidate& lasting, int segments);

/// A candidate that is on for a part as one that is on again before or after, or pauses in between: the best
/// of all times between `segments` equal parts, where that is more than chance; itself where none is.
Candidate withPauses(const WhitenedModel& model, const Candidate& part, int segments);

}  // namespace fathom
