#pragma once

#include <string>
#include <vector>

#include "diagnosis/adequacy.h"
#include "diagnosis/held_out.h"
#include "diagnosis/manoeuvre.h"
#include "diagnosis/mismatch.h"
#include "diagnosis/screening.h"
#include "estimation/batch_estimate.h"

/// What a diagnosis has found.
namespace fathom {

enum class Verdict {
  none,         ///< nothing material is missing
  explained,    ///< effects of the catalogue are missing, and take away 95 % of what can be taken away
  unexplained,  ///< something is missing besides the effects that were found, or instead of any
  insufficient  ///< the recording could not show it either way
};
/// "none", …, as in results.
std::string nameOf(Verdict verdict);

struct FoundEffect {
  Candidate candidate;
  std::vector<EffectEstimate> estimates;
  double sqrt_lambda = 0;  ///< its size in units of what the recording could resolve at best
  double log_odds = 0;     ///< for it, against the model without it, everything refitted
  double confidence = 0;   ///< that it is this one: by its odds, all others' in its place and nothing's, and
                           ///< by what is left on the same readings beside it
  double log_likelihood_gain = 0;  ///< over the model without it, all that is unknown integrated out
  double bic_gain = 0;             ///< what the BIC approximates: twice that
  double heldout_log_likelihood_gain = 0;
  double share = 0;  ///< of the mismatch, what it takes away on stretches that it was not fitted to
  std::vector<InteractionTest> interactions;
};

/// Effects among which the recording cannot choose: each explains what the first does.
struct Alternatives {
  std::vector<Candidate> candidates;  ///< the effect stated, then those as good
  std::vector<double> log_odds;       ///< against the first's, 0 or a little less
  std::vector<double> alignment;      ///< |cos| with the first: 1 is the same to this recording
  Advice advice;                      ///< for telling the first from the one most like it
};

/// What is left of the mismatch beside the effects found.
struct Remainder {
  double share = 0;  ///< of what can be taken away
  std::string where, unit;
  double size = 0;        ///< in that unit, root mean square beyond chance
  bool material = false;  ///< large enough to matter; nothing that is not is any remainder
};

/// A component of the error budget, or the noise of a channel, as the recording shows it.
struct BudgetEntry {
  std::string component, unit, source;
  double prior = 0, estimate = 0;
  double log_sd = 0;  ///< of the estimate's logarithm
  /// ln of how much likelier the readings are so than were it just what 99 % of such are at most.
  double beyond = 0;
  bool bursts = false;  ///< it would have to be beyond, by odds of twenty to one
  /// Where values are that are not of the others' kind, and how large the largest of them is.
  std::vector<std::string> apart;
  double largest_apart = 0;
  /// Of a noise that bursts: the share of readings far beyond what the others scatter by, where that is more
  /// than the budget has, and what these do (in `unit`).
  double outlier_share = 0, others = 0;
};

/// A hypothesis and how likely it is, of all that were looked at.
struct Hypothesis {
  std::vector<Candidate> effects;  ///< none: nothing is missing
  bool is_something_else = false;  ///< what no effect of the catalogue is
  double mass = 0;
};

/// What is within the budget, and would not be within a tighter one.
struct Allowed {
  TestedCandidate most;  ///< telling
  std::string budget, tight_budget;
};

struct Diagnosis {
  Verdict verdict = Verdict::none;
  std::string why;  ///< a paragraph for a person
  NoiseModel noise;
  std::vector<TestedCandidate> tested;  ///< at the nominal model, best supported first
  /// Of the most improbable of all that were believed possible, having looked at all.
  double alarm_p = 1;
  std::string most_improbable;
  double log_odds = 0;              ///< of all effects that were found together, against none
  double log_likelihood_gain = 0;   ///< of all together, all that is unknown integrated out
  std::vector<Mismatch> mismatch;   ///< of the nominal model, worst first
  std::vector<Mismatch> remaining;  ///< of the final one
  std::vector<FoundEffect> effects;
  std::optional<Allowed> allowed;
  std::vector<Alternatives> alternatives;
  Remainder remainder;
  std::vector<BudgetEntry> budget;
  std::vector<Hypothesis> posterior;           ///< the likeliest first
  HeldOutResult heldout;                       ///< empty where no effect was found
  EffectParameters<double> calibration;        ///< with all effects found: `simulate` and `localize` take it;
                                               ///< wholeOf() what the estimates below have
  BatchEstimate before, after;                 ///< the nominal model's estimate, and the final one's
  BatchOptions before_options, after_options;  ///< with which they were made: for problemAt()
  std::vector<std::string> remarks;
};

}  // namespace fathom
