#include "diagnosis/onset.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/allowance.h"
#include "diagnosis/constants.h"
#include "diagnosis/evidence.h"

namespace fathom {
namespace {

/// The edges of a candidate that are times of the recording.
std::vector<double*> edgesOf(Candidate& candidate) {
  std::vector<double*> edges;
  if (candidate.time_s) edges.push_back(&*candidate.time_s);
  if (candidate.peak) edges.push_back(&candidate.peak->time_s);
  if (candidate.peak) edges.push_back(&candidate.peak->width_s);
  if (candidate.active_s.from_s > -Interval::kForever_s) edges.push_back(&candidate.active_s.from_s);
  if (candidate.active_s.to_s < Interval::kForever_s) edges.push_back(&candidate.active_s.to_s);
  for (Interval::Pause& pause : candidate.active_s.pauses)
    if (pause.isOne()) edges.insert(edges.end(), {&pause.from_s, &pause.to_s});
  return edges;
}

bool isInOrder(const Interval& interval) {
  for (const auto& [from_s, to_s] : interval.parts())
    if (from_s >= to_s) return false;
  return true;
}

/// Whether there are readings of each of its parts.
bool isSeen(const Interval& interval, const Interval& span) {
  for (const auto& [from_s, to_s] : interval.parts())
    if (to_s <= span.from_s || from_s >= span.to_s) return false;
  return true;
}

/// With one more pause; nothing where it has as many as it can, or they would overlap.
std::optional<Interval> withPause(Interval interval, double from_s, double to_s) {
  const auto free = std::find_if(interval.pauses.begin(), interval.pauses.end(),
                                 [](const Interval::Pause& pause) { return !pause.isOne(); });
  if (free == interval.pauses.end()) return {};
  for (auto pause = interval.pauses.begin(); pause != free; ++pause)
    if (from_s <= pause->to_s && pause->from_s <= to_s) return {};
  *free = {from_s, to_s};
  std::sort(interval.pauses.begin(), free + 1,
            [](const Interval::Pause& a, const Interval::Pause& b) { return a.from_s < b.from_s; });
  return isInOrder(interval) ? std::optional(interval) : std::nullopt;
}

}  // namespace

std::vector<double> evidencesOf(const WhitenedModel& model, const std::vector<Candidate>& candidates) {
  const std::vector<Reduced> reduced = model.reduceEach(candidates);
  std::vector<double> evidences;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    evidences.push_back(EffectEvidence(reduced[i].gram, priorSigmas(model.linear(), {candidates[i]}))
                            .best(reduced[i].score)
                            .log_bayes_factor);
  return evidences;
}

Candidate refinedInterval(const WhitenedModel& model, Candidate candidate, double step_s) {
  const Interval span = readingsSpan(model.linear());
  for (; step_s > kFinest_s; step_s *= 0.5)
    for (std::size_t edge = 0; edge < edgesOf(candidate).size(); ++edge) {
      std::vector<Candidate> tried;
      for (const int k : {0, -2, -1, 1, 2}) {
        tried.push_back(candidate);
        *edgesOf(tried.back())[edge] += 0.5 * k * step_s;
        const Candidate& last = tried.back();
        const bool is_outside = last.time_s && !(*last.time_s > span.from_s && *last.time_s < span.to_s);
        if (is_outside || !isInOrder(last.active_s) || !isSeen(last.active_s, span) ||
            (last.peak && last.peak->width_s <= 0))
          tried.pop_back();
      }
      const std::vector<double> evidence = evidencesOf(model, tried);
      candidate = tried[static_cast<std::size_t>(std::max_element(evidence.begin(), evidence.end()) -
                                                 evidence.begin())];
    }
  return candidate;
}

Candidate bestInterval(const WhitenedModel& model, const Candidate& lasting, int segments) {
  const Interval span = readingsSpan(model.linear());
  const double first_s = span.from_s, last_s = span.to_s;
  const double step_s = (last_s - first_s) / segments;
  std::vector<Candidate> tried{lasting};
  for (int from = 0; from < segments; ++from)
    for (int to = from + 1; to <= segments; ++to) {
      if (to - from == segments) continue;
      tried.push_back(lasting);
      if (from > 0) tried.back().active_s.from_s = first_s + from * step_s;
      if (to < segments) tried.back().active_s.to_s = first_s + to * step_s;
    }
  const std::vector<double> evidence = evidencesOf(model, tried);
  const auto best = std::max_element(evidence.begin(), evidence.end()) - evidence.begin();
  if (evidence[static_cast<std::size_t>(best)] < evidence[0] + std::log(tried.size())) return lasting;
  return refinedInterval(model, tried[static_cast<std::size_t>(best)], step_s);
}

Candidate withPauses(const WhitenedModel& model, const Candidate& part, int segments) {
  if (!comesAndGoes(part)) return part;
  const Interval span = readingsSpan(model.linear());
  const double first_s = span.from_s, last_s = span.to_s;
  const double step_s = (last_s - first_s) / segments;
  std::vector<Candidate> tried{part};
  const auto add = [&](const std::optional<Interval>& active_s) {
    if (!active_s) return;
    tried.push_back(part);
    tried.back().active_s = *active_s;
  };
  const Interval& own = part.active_s;
  for (int from = 0; from < segments; ++from)
    for (int to = from + 1; to <= segments; ++to) {
      const double from_s = first_s + from * step_s, to_s = first_s + to * step_s;
      Interval longer = own;
      if (from_s > own.from_s && to_s < own.to_s)
        add(withPause(own, from_s, to_s));
      else if (from_s > own.to_s) {  // on again afterwards
        longer.to_s = to == segments ? Interval::kForever_s : to_s;
        add(withPause(longer, own.to_s, from_s));
      } else if (to_s < own.from_s) {  // and before
        longer.from_s = from == 0 ? -Interval::kForever_s : from_s;
        add(withPause(longer, to_s, own.from_s));
      }
    }
  const std::vector<double> evidence = evidencesOf(model, tried);
  const auto best = std::max_element(evidence.begin(), evidence.end()) - evidence.begin();
  if (evidence[static_cast<std::size_t>(best)] < evidence[0] + std::log(0.5 * segments * (segments + 1)))
    return part;
  return withPauses(model, tried[static_cast<std::size_t>(best)], segments);
}

}  // namespace fathom
