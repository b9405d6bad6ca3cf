#include "diagnosis/onset.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/screening.h"

namespace fathom {
namespace {

constexpr double kFinest_s = 0.1;
constexpr double kBetter = 5.0;  // ln p, for having looked at so many intervals

/// -ln p of each.
std::vector<double> evidences(const WhitenedModel& model, const std::vector<Candidate>& candidates) {
  const std::vector<Reduced> reduced = model.reduceEach(candidates);
  std::vector<double> evidences;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    evidences.push_back(
        support(reduced[i].gram, reduced[i].score, priorSigmas(model.linear(), {candidates[i]})));
  return evidences;
}

/// The edges of a candidate that are times of the recording.
std::vector<double*> edgesOf(Candidate& candidate) {
  std::vector<double*> edges;
  if (candidate.time_s) edges.push_back(&*candidate.time_s);
  if (candidate.peak) edges.push_back(&candidate.peak->time_s);
  if (candidate.peak) edges.push_back(&candidate.peak->width_s);
  if (candidate.active_s.from_s > -Interval::kForever_s) edges.push_back(&candidate.active_s.from_s);
  if (candidate.active_s.to_s < Interval::kForever_s) edges.push_back(&candidate.active_s.to_s);
  return edges;
}

}  // namespace

Candidate refinedInterval(const WhitenedModel& model, Candidate candidate, double step_s) {
  for (; step_s > kFinest_s; step_s *= 0.5)
    for (std::size_t edge = 0; edge < edgesOf(candidate).size(); ++edge) {
      std::vector<Candidate> tried;
      for (const int k : {0, -2, -1, 1, 2}) {
        tried.push_back(candidate);
        *edgesOf(tried.back())[edge] += 0.5 * k * step_s;
        const Candidate& last = tried.back();
        if (last.active_s.from_s >= last.active_s.to_s || (last.peak && last.peak->width_s <= 0))
          tried.pop_back();
      }
      const std::vector<double> evidence = evidences(model, tried);
      candidate = tried[static_cast<std::size_t>(std::max_element(evidence.begin(), evidence.end()) -
                                                 evidence.begin())];
    }
  return candidate;
}

Candidate bestInterval(const WhitenedModel& model, const Candidate& lasting, int segments) {
  const auto [first_s, last_s] = readingsSpan(model.linear());
  const double step_s = (last_s - first_s) / segments;
  std::vector<Candidate> tried{lasting};
  for (int from = 0; from < segments; ++from)
    for (int to = from + 1; to <= segments; ++to) {
      if (to - from == segments) continue;
      tried.push_back(lasting);
      if (from > 0) tried.back().active_s.from_s = first_s + from * step_s;
      if (to < segments) tried.back().active_s.to_s = first_s + to * step_s;
    }
  const std::vector<double> evidence = evidences(model, tried);
  const auto best = std::max_element(evidence.begin(), evidence.end()) - evidence.begin();
  if (evidence[static_cast<std::size_t>(best)] < evidence[0] + kBetter) return lasting;
  return refinedInterval(model, tried[static_cast<std::size_t>(best)], step_s);
}

}  // namespace fathom
