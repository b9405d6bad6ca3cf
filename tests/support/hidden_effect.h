#pragma once

#include <vector>

#include "core/random.h"
#include "diagnosis/candidate.h"

/// Effects to hide in recordings, for the proof and for tests of the diagnosis.
namespace fathom::test {

/// lambda (1 - |c|) below which two effects cannot be told apart at 5 %; c: the cosine between what one does
/// to the readings and the nearest that the other can.
inline constexpr double kSeparable = 5.4;

/// An effect of a size, as the program has it.
struct Hidden {
  Candidate candidate;
  EffectParameters<double> effects;  ///< the candidate's on, at its values
};

/// An effect at random: its parameters in units of what an engineer expects and as physics lets them be, one
/// of the markers, its time or peak in the recording's middle half. On for good.
Hidden randomEffect(const EffectInfo& effect, const std::vector<int>& marker_ids, double duration_s,
                    Random& random);
/// From 10 to 40 % of a recording on, for 30 to 50 % of it.
Interval randomInterval(double duration_s, Random& random);
/// The same effect, on then only.
Hidden activeDuring(Hidden hidden, const Interval& active_s);

/// Effects that are on, so many times as large; where and when they are stays.
EffectParameters<double> scaled(EffectParameters<double> effects, double factor);
/// Whether no parameter is larger than anybody would hide.
bool isWithinLimits(const EffectParameters<double>& effects);

/// An effect as it may be in a recording: for good, of each marker, at each tenth of it.
std::vector<Candidate> candidatesOf(const EffectInfo& effect, const std::vector<int>& marker_ids,
                                    const Interval& span);

}  // namespace fathom::test
