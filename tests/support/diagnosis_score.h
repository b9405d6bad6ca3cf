#pragma once

#include <array>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "support/diagnosis_runs.h"

/// What a diagnosis is worth, next to what its recording hides.
namespace fathom::test {

enum class Outcome {
  right,         ///< the hidden effect and no other
  right_set,     ///< a set with it, of effects that cannot be told apart on this recording
  needless_set,  ///< a set with it, in which some can be told apart
  also_others,   ///< it, and effects that are not there
  wrong,         ///< effects named of which none, nor any set, is the hidden one
  unexplained,
  none,
  insufficient,
  refused  ///< an Error
};
inline constexpr std::array kOutcomes{"right",       "right set", "needless set", "also others", "wrong",
                                      "unexplained", "none",      "insufficient", "refused"};
std::string nameOf(Outcome outcome);

struct Answer {
  Outcome outcome = Outcome::insufficient;
  std::vector<std::string> named;   ///< effects stated, each with what it cannot be told from
  int scalars = 0, covered = 0;     ///< of the hidden effect's parameters: those in their 95 % interval
  bool interval_off = false;        ///< on, or moved, at other times than the hidden effect, by more than 5 s
  bool interaction_failed = false;  ///< of any effect stated
  std::vector<std::string> nearest;  ///< effects that failed a test
  double alarm_p = 1;
  std::size_t rank = 0;     ///< of the hidden effect among all tested: 1 is the best; 0: none
  std::string best_tested;  ///< at the nominal model
  std::string why;
};

/// For a test that fails.
std::string told(const Answer& answer);

/// `excitation` is that of the recording's path.
Answer score(const Diagnosis& diagnosis, const DiagnosisRun& run, const Excitation& excitation);

/// An Error is an answer too.
Answer answerOf(const DiagnosisRun& run, const Excitation& excitation, const DiagnosisOptions& options = {});

/// What is asked where an effect is hidden.
bool namesTheEffect(const Answer& answer);
/// What is asked of something outside the catalogue: "unexplained", or a set with a failed interaction test.
bool ownsUp(const Answer& answer);
/// What is asked of wrong input: never a confident name.
bool isCautious(const Answer& answer);

}  // namespace fathom::test
