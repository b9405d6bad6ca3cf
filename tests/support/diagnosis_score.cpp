#include "support/diagnosis_score.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"

namespace fathom::test {

std::string nameOf(Outcome outcome) { return kOutcomes[static_cast<std::size_t>(outcome)]; }

std::string told(const Answer& answer) {
  std::string text = nameOf(answer.outcome) + ": ";
  for (const std::string& name : answer.named) text += name + "; ";
  return text + answer.why;
}

namespace {

/// A moved panel's onset and a current's interval are its parameters, not its name.
bool sameName(const Candidate& a, const Candidate& b) {
  return a.effect == b.effect && a.marker_id == b.marker_id && a.sensor == b.sensor && a.region == b.region;
}

const Alternatives* setOf(const Diagnosis& diagnosis, const Candidate& stated) {
  for (const Alternatives& set : diagnosis.alternatives)
    if (!set.candidates.empty() && sameName(set.candidates.front(), stated)) return &set;
  return nullptr;
}

std::string described(const Diagnosis& diagnosis, const FoundEffect& found) {
  std::string text = nameOf(found.candidate);
  if (const Alternatives* set = setOf(diagnosis, found.candidate))
    for (std::size_t i = 1; i < set->candidates.size(); ++i) text += " | " + nameOf(set->candidates[i]);
  return text;
}

/// Whether from when to when, within the recording, is stated more than 5 s off.
bool isIntervalOff(const Candidate& stated, const Candidate& truth, double duration_s) {
  const auto differs = [&](double a_s, double b_s) {
    return std::abs(std::clamp(a_s, 0.0, duration_s) - std::clamp(b_s, 0.0, duration_s)) > 5.0;
  };
  return differs(stated.active_s.from_s, truth.active_s.from_s) ||
         differs(stated.active_s.to_s, truth.active_s.to_s) ||
         differs(stated.time_s.value_or(0), truth.time_s.value_or(0)) ||
         differs(stated.peak.value_or(Peak{}).time_s, truth.peak.value_or(Peak{}).time_s);
}

void countCovered(const FoundEffect& found, const EffectParameters<double>& truth, Answer& answer) {
  for (const EffectEstimate& estimate : found.estimates) {
    ++answer.scalars;
    if (std::abs(estimate.value - truth.values[estimate.scalar]) < 1.96 * estimate.sigma) ++answer.covered;
  }
}

Outcome ofHidden(const Diagnosis& diagnosis, const DiagnosisRun& run, const Excitation& excitation,
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
  const Eigen::VectorXd signal = own.signal(run.run.effects, run.run.seed);
  const bool inseparable =
      std::all_of(set->candidates.begin(), set->candidates.end(), [&](const Candidate& rival) {
        return sameName(rival, truth) || own.separability(signal, rival) < kSeparable;
      });
  return inseparable ? Outcome::right_set : Outcome::needless_set;
}

}  // namespace

Answer score(const Diagnosis& diagnosis, const DiagnosisRun& run, const Excitation& excitation) {
  Answer answer;
  answer.why = diagnosis.why;
  answer.alarm_p = diagnosis.alarm_p;
  for (const FoundEffect& found : diagnosis.effects) {
    answer.named.push_back(described(diagnosis, found));
    for (const InteractionTest& test : found.interactions)
      answer.interaction_failed = answer.interaction_failed || test.failed;
  }
  if (diagnosis.verdict == Verdict::unexplained) answer.nearest.swap(answer.named);
  if (!diagnosis.tested.empty()) {
    const TestedCandidate& best = diagnosis.tested.front();
    answer.best_tested =
        print("%s: chi-square %.0f of %d", nameOf(best.candidate).c_str(), best.statistic, best.dof);
  }
  if (run.truth)
    for (std::size_t i = 0; i < diagnosis.tested.size() && answer.rank == 0; ++i)
      if (sameName(diagnosis.tested[i].candidate, *run.truth)) answer.rank = i + 1;
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
      answer.outcome = run.truth ? ofHidden(diagnosis, run, excitation, answer) : Outcome::wrong;
  }
  return answer;
}

Answer answerOf(const DiagnosisRun& run, const Excitation& excitation, const DiagnosisOptions& options) {
  try {
    return score(diagnose(run.input(), options), run, excitation);
  } catch (const Error& error) {
    Answer answer;
    answer.outcome = Outcome::refused;
    answer.why = error.what();
    return answer;
  }
}

bool namesTheEffect(const Answer& answer) {
  return answer.outcome == Outcome::right || answer.outcome == Outcome::right_set;
}

bool ownsUp(const Answer& answer) {
  const bool a_set = std::any_of(answer.named.begin(), answer.named.end(),
                                 [](const std::string& name) { return name.find('|') != std::string::npos; });
  return answer.outcome == Outcome::unexplained || (a_set && answer.interaction_failed);
}

bool isCautious(const Answer& answer) {
  return answer.outcome != Outcome::wrong ||
         std::all_of(answer.named.begin(), answer.named.end(),
                     [](const std::string& name) { return name.find('|') != std::string::npos; });
}

}  // namespace fathom::test
