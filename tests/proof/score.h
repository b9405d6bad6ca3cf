#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "proof_case.h"

namespace fathom::proof {

/// What an answer is worth, next to what its recording hides.
enum class Outcome {
  right,         ///< what is hidden and nothing else
  right_set,     ///< a set with it, of effects that cannot be told apart on this recording
  needless_set,  ///< a set with it, in which some can be told apart
  also_others,   ///< it, and effects that are not there
  half,          ///< one of two
  wrong,
  unexplained,
  none,
  insufficient,
  failed  ///< the program gave no answer
};
inline constexpr std::array kOutcomes{"right", "right set",   "needless set", "also others",  "half",
                                      "wrong", "unexplained", "none",         "insufficient", "failed"};
inline const char* nameOf(Outcome outcome) { return kOutcomes[static_cast<std::size_t>(outcome)]; }

/// What was found is worth on another dive, where nothing was fitted: ln of the likelihood gained over the
/// nominal model.
struct Gains {
  double truth = 0;      ///< with what is true
  double stated = 0;     ///< with what was stated
  double runner_up = 0;  ///< with the effect most like the hidden one, fitted to the recording
  double black_box = 0;
};

/// What was found is worth on stretches of its own recording that it was not fitted to: ln of the likelihood
/// gained over the nominal model.
struct OwnStretches {
  double physics = 0, black_box = 0;
  double over_black_box = 0;  ///< lower end of the 95 % interval of their difference
  double placebo = 0;         ///< what the best of all effects gains where nothing is missing
};

/// What became of a set on the dive that the answer advises.
struct Advised {
  std::string manoeuvre;
  int minutes = 1;
  double from_s = 0;  ///< of the first recording: where the manoeuvre begins
  Outcome outcome = Outcome::failed;
  std::vector<std::string> stated;
  std::string failure;
};

struct Scored {
  ProofCase proof_case;
  Outcome outcome = Outcome::insufficient;
  std::string failure;                   ///< why there is no answer
  std::vector<std::string> stated;       ///< each with what it cannot be told from: "gamma | dark-offset"
  bool in_set = false;                   ///< all that is hidden is stated, or in a stated set
  double set_size = 0;                   ///< of the stated sets, mean
  double confidence = 0;                 ///< stated, that the first name is right; 0: nothing was named
  bool first_right = false;              ///< the first name of a set is right
  int scalars = 0, covered = 0;          ///< of what is hidden: those in their 95 % interval
  std::optional<double> parameters_off;  ///< of the first effect that is hidden: a share of their size
  bool rival_in_set = false;             ///< what it may be taken for is in the stated set
  std::optional<double> onset_off_s;     ///< of an interval's beginning, a step, a peak
  std::optional<double> end_off_s;       ///< of an interval
  std::optional<OwnStretches> own;
  std::optional<Gains> gains;
  std::optional<Advised> advised;
};

/// `answer`: result.json of `fathom diagnose`. Throws nlohmann::json::exception.
Scored score(const ProofCase& proof_case, const nlohmann::json& answer);

/// Whether what is hidden is bound to a time: an interval, a step, a peak.
bool isTimed(const nlohmann::json& hidden_effect);

nlohmann::ordered_json toJson(const Scored& scored);
Scored scoredOf(const nlohmann::json& json);

}  // namespace fathom::proof
