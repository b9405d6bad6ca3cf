#pragma once

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "diagnosis/diagnosis.h"
#include "support/diagnosis_runs.h"

/// What a diagnosis is worth, next to what its recording hides.
namespace fathom::test {

/// Below this lambda (1 - |c|) two effects cannot be told apart at 5 % (see Candidate, Excitation).
inline constexpr double kSeparable = 5.4;

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
inline std::string nameOf(Outcome outcome) { return kOutcomes[static_cast<std::size_t>(outcome)]; }

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

namespace detail {

/// A moved panel's onset and a current's interval are its parameters, not its name.
inline bool sameName(const Candidate& a, const Candidate& b) {
  return a.effect == b.effect && a.marker_id == b.marker_id;
}

inline const Alternatives* setOf(const Diagnosis& diagnosis, const Candidate& stated) {
  for (const Alternatives& set : diagnosis.alternatives)
    if (!set.candidates.empty() && sameName(set.candidates.front(), stated)) return &set;
  return nullptr;
}

inline std::string described(const Diagnosis& diagnosis, const FoundEffect& found) {
  std::string text = nameOf(found.candidate);
  if (const Alternatives* set = setOf(diagnosis, found.candidate))
    for (std::size_t i = 1; i < set->candidates.size(); ++i) text += " | " + nameOf(set->candidates[i]);
  return text;
}

/// Whether from when to when, within the recording, is stated more than 5 s off.
inline bool isIntervalOff(const Candidate& stated, const Candidate& truth, double duration_s) {
  const auto differs = [&](double a_s, double b_s) {
    return std::abs(std::clamp(a_s, 0.0, duration_s) - std::clamp(b_s, 0.0, duration_s)) > 5.0;
  };
  return differs(stated.active_s.from_s, truth.active_s.from_s) ||
         differs(stated.active_s.to_s, truth.active_s.to_s) ||
         differs(stated.time_s.value_or(0), truth.time_s.value_or(0));
}

inline void countCovered(const FoundEffect& found, const EffectParameters<double>& truth, Answer& answer) {
  for (const EffectEstimate& estimate : found.estimates) {
    ++answer.scalars;
    if (std::abs(estimate.value - truth.values[estimate.scalar]) < 1.96 * estimate.sigma) ++answer.covered;
  }
}

inline Outcome ofHidden(const Diagnosis& diagnosis, const DiagnosisRun& run, const Excitation& excitation,
                        Answer& answer) {
  const Excitation& own = run.excitation ? *run.excitation : excitation;
  const Candidate& truth = *run.truth;
  const auto hit =
      std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const FoundEffect& f) {
        if (sameName(f.candidate, truth)) return true;
        const Alternatives* set = setOf(diagnosis, f.candidate);
        return set != nullptr && std::any_of(set->candidates.begin(), set->candidates.end(),
                                             [&](const Candidate& c) { return sameName(c, truth); });
      });
  if (hit == diagnosis.effects.end()) return Outcome::wrong;
  if (sameName(hit->candidate, truth)) {
    countCovered(*hit, run.run.effects, answer);
    answer.interval_off = isIntervalOff(hit->candidate, truth, run.run.duration_s);
  }
  if (diagnosis.effects.size() > 1) return Outcome::also_others;
  const Alternatives* set = setOf(diagnosis, hit->candidate);
  if (set == nullptr || set->candidates.size() < 2) return Outcome::right;
  const Eigen::VectorXd signal = own.signal(run.run.effects);
  const bool inseparable =
      std::all_of(set->candidates.begin(), set->candidates.end(), [&](const Candidate& rival) {
        return sameName(rival, truth) || own.separability(signal, rival) < kSeparable;
      });
  return inseparable ? Outcome::right_set : Outcome::needless_set;
}

}  // namespace detail

/// `excitation` is that of the recording's path.
inline Answer score(const Diagnosis& diagnosis, const DiagnosisRun& run, const Excitation& excitation) {
  Answer answer;
  answer.why = diagnosis.why;
  answer.alarm_p = diagnosis.alarm_p;
  for (const FoundEffect& found : diagnosis.effects) {
    answer.named.push_back(detail::described(diagnosis, found));
    for (const InteractionTest& test : found.interactions)
      answer.interaction_failed = answer.interaction_failed || test.failed;
  }
  for (const FoundEffect& found : diagnosis.nearest)
    answer.nearest.push_back(detail::described(diagnosis, found));
  if (!diagnosis.tested.empty()) {
    const TestedCandidate& best = diagnosis.tested.front();
    answer.best_tested =
        print("%s: chi-square %.0f of %d", nameOf(best.candidate).c_str(), best.statistic, best.dof);
  }
  if (run.truth)
    for (std::size_t i = 0; i < diagnosis.tested.size() && answer.rank == 0; ++i)
      if (detail::sameName(diagnosis.tested[i].candidate, *run.truth)) answer.rank = i + 1;
  switch (diagnosis.verdict) {
    case Verdict::none:
      answer.outcome = Outcome::none;
      break;
    case Verdict::unexplained:
      answer.outcome = Outcome::unexplained;
      break;
    case Verdict::insufficient:
      answer.outcome = Outcome::insufficient;
      break;
    case Verdict::explained:
      answer.outcome = run.truth ? detail::ofHidden(diagnosis, run, excitation, answer) : Outcome::wrong;
  }
  return answer;
}

/// An Error is an answer too.
inline Answer answerOf(const DiagnosisRun& run, const Excitation& excitation,
                       const DiagnosisOptions& options = {}) {
  try {
    return score(diagnose(run.input(), options), run, excitation);
  } catch (const Error& error) {
    Answer answer;
    answer.outcome = Outcome::refused;
    answer.why = error.what();
    return answer;
  }
}

/// What is asked where an effect is hidden.
inline bool namesTheEffect(const Answer& answer) {
  return answer.outcome == Outcome::right || answer.outcome == Outcome::right_set;
}
/// What is asked of something outside the catalogue: "unexplained", or a set with a failed interaction test.
inline bool ownsUp(const Answer& answer) {
  const bool a_set = std::any_of(answer.named.begin(), answer.named.end(),
                                 [](const std::string& name) { return name.find('|') != std::string::npos; });
  return answer.outcome == Outcome::unexplained || (a_set && answer.interaction_failed);
}
/// What is asked of wrong input: never a confident name.
inline bool isCautious(const Answer& answer) {
  return answer.outcome != Outcome::wrong ||
         std::all_of(answer.named.begin(), answer.named.end(),
                     [](const std::string& name) { return name.find('|') != std::string::npos; });
}

}  // namespace fathom::test
