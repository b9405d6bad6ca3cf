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
  explained,    ///< effects of the catalogue are missing, and with them nothing else is
  unexplained,  ///< something is missing that no effect of the catalogue describes
  insufficient  ///< the recording could not show it either way
};
/// "none", …, as in results.
std::string nameOf(Verdict verdict);

struct FoundEffect {
  Candidate candidate;
  std::vector<EffectEstimate> estimates;
  double sqrt_lambda = 0;  ///< its size in units of what the recording could resolve at best
  double support = 0;      ///< -ln p against the model without it, everything refitted
  double confidence = 0;   ///< that it is this one: by its support and that of all others in its place
  double log_likelihood_gain = 0;  ///< of the best fits, over the model without it
  double bic_gain = 0;
  double heldout_log_likelihood_gain = 0;
  std::vector<InteractionTest> interactions;
};

/// Effects among which the recording cannot choose: each explains what the first does.
struct Alternatives {
  std::vector<Candidate> candidates;  ///< the effect stated, then those as good
  std::vector<double> support;        ///< against the first's, 0 or a little less
  std::vector<double> alignment;      ///< |cos| with the first: 1 is the same to this recording
  Advice advice;                      ///< for telling the first from the one most like it
};

struct Diagnosis {
  Verdict verdict = Verdict::none;
  std::string why;  ///< a paragraph for a person
  NoiseModel noise;
  std::vector<TestedCandidate> tested;  ///< at the nominal model, best supported first
  /// Of the most improbable of all that were believed possible, having looked at all.
  double alarm_p = 1;
  std::string most_improbable;
  /// It is no chance, but moves readings by less than they may be off anyway (isBeyondBias).
  bool is_within_bias = false;
  std::vector<Mismatch> mismatch;   ///< of the nominal model, worst first
  std::vector<Mismatch> remaining;  ///< of the final one
  std::vector<FoundEffect> effects;
  std::vector<FoundEffect> nearest;  ///< unexplained: effects that come near, but fail a test
  std::vector<Alternatives> alternatives;
  HeldOutResult heldout;                       ///< empty where no effect was found
  EffectParameters<double> calibration;        ///< with all effects found: `simulate` and `localize` take it;
                                               ///< wholeOf() what the estimates below have
  BatchEstimate before, after;                 ///< the nominal model's estimate, and the final one's
  BatchOptions before_options, after_options;  ///< with which they were made: for problemAt()
  std::vector<std::string> remarks;
};

}  // namespace fathom
