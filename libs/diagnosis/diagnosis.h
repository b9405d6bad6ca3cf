#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/candidate.h"
#include "diagnosis/held_out.h"
#include "diagnosis/mismatch.h"
#include "diagnosis/noise.h"
#include "estimation/batch_estimate.h"

/// Which physics a recording shows that its model leaves out: locate, attribute, model, verify.
namespace fathom {

enum class Verdict {
  none,         ///< nothing material is missing
  explained,    ///< effects of the catalogue are missing, and with them nothing else is
  unexplained,  ///< something is missing that no effect of the catalogue describes
  insufficient  ///< the recording could not show it either way
};
/// "none", …, as in results.
std::string nameOf(Verdict verdict);

/// An effect tested at the model without it: to first order, with all that is estimated anyway projected off.
struct TestedCandidate {
  Candidate candidate;
  double statistic = 0;  ///< score statistic: chi-square of `dof` where the effect is not there
  int dof = 0;
  double log_p = 0;         ///< ln of its probability where nothing is missing, for this candidate alone
  double log_evidence = 0;  ///< ln of the Bayes factor against "not there", with the parameters' priors
  double kept = 0;          ///< |C_perp| / |C|: what the nuisances leave of it
  std::vector<EffectEstimate> one_step;  ///< its parameters so
  std::optional<double> refitted_gain;   ///< 2 ln likelihood gained by the whole refit, where it was refitted
};

/// Whether an effect's parameters are the same all over the recording.
struct InteractionTest {
  std::string against;  ///< "time", "speed", …
  double statistic = 0, log_p = 0;
  int dof = 0;
  double relative_change = 0;  ///< of the effect over one standard deviation of the covariate
};

struct FoundEffect {
  Candidate candidate;
  std::vector<EffectEstimate> estimates;
  double sqrt_lambda = 0;  ///< its size in units of what the recording could resolve at best
  double log_likelihood_gain = 0, bic_gain = 0;  ///< against the model without it, everything refitted
  double heldout_log_likelihood_gain = 0;
  std::vector<InteractionTest> interactions;
};

/// Effects among which the recording cannot choose: each explains what the first does.
struct Alternatives {
  std::vector<Candidate> candidates;  ///< the effect stated, then those as good
  std::vector<double> log_evidence;
  std::vector<double> alignment;  ///< |c| with the first: 1 is the same to this recording
};

struct Diagnosis {
  Verdict verdict = Verdict::none;
  std::string why;  ///< a paragraph for a person
  NoiseModel noise;
  std::vector<TestedCandidate> tested;  ///< at the nominal model, best evidence first
  double alarm_p = 1;                   ///< of the best of all, having looked at all: by simulation
  std::vector<Mismatch> mismatch;       ///< of the nominal model, worst first
  std::vector<Mismatch> remaining;      ///< of the final one
  std::vector<FoundEffect> effects;
  std::vector<Alternatives> alternatives;
  std::vector<HeldOut> heldout;          ///< the metric of the effects' own channel first
  EffectParameters<double> calibration;  ///< with all effects found: `simulate` and `localize` take it
  BatchEstimate before, after;           ///< the nominal model's estimate, and the final one's
  std::vector<std::string> remarks;
};

struct DiagnosisOptions {
  EffectParameters<double> calibration;  ///< what is known already, e.g. nominal but for this
  double false_alarm = 0.05;             ///< of a recording with nothing missing
  int max_effects = 3;
  int segments = 30;  ///< onsets and ends are looked for at so many places first
  int folds = 5;
  std::uint64_t seed = 1;  ///< of the simulated nulls
};

/// Throws Interrupted.
Diagnosis diagnose(const BatchInput& input, const DiagnosisOptions& options = {});

}  // namespace fathom
