#include "diagnosis/alternatives.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/stable_sort.h"
#include "diagnosis/adequacy.h"
#include "diagnosis/constants.h"
#include "diagnosis/onset.h"
#include "diagnosis/screening.h"

namespace fathom {
namespace {

/// Of the candidates to first order, the same one at the time that is best; nothing where there is none.
std::optional<std::size_t> nearestOf(const Candidate& stated,
                                     const std::vector<TestedCandidate>& candidates) {
  std::optional<std::size_t> nearest;
  for (std::size_t m = 0; m < candidates.size(); ++m)
    if (isSameButTime(candidates[m].candidate, stated) &&
        (!nearest || candidates[m].log_evidence > candidates[*nearest].log_evidence))
      nearest = m;
  return nearest;
}

/// All others, best supported first.
std::vector<std::size_t> othersThan(const Candidate& stated, const std::vector<TestedCandidate>& candidates) {
  std::vector<std::size_t> order;
  for (std::size_t m = 0; m < candidates.size(); ++m)
    if (!isSameButTime(candidates[m].candidate, stated)) order.push_back(m);
  stableSort(order, [&](std::size_t a, std::size_t b) {
    return candidates[a].log_evidence > candidates[b].log_evidence;
  });
  return order;
}

bool isListed(const Candidate& candidate, const Alternatives& set) {
  return std::any_of(set.candidates.begin(), set.candidates.end(),
                     [&](const Candidate& other) { return isSameButTime(other, candidate); });
}

/// What could be there instead, and how alike it is to first order.
struct Rival {
  Candidate candidate;
  double alignment = 0;
};

/// The few that come near to the one of the screening's candidates.
std::vector<Rival> rivalsOf(std::size_t own, const Screening& screening, const WhitenedModel& without,
                            double segment_s) {
  const auto& candidates = screening.candidates();
  std::vector<Rival> rivals;
  for (const std::size_t m : othersThan(candidates[own].candidate, candidates)) {
    if (candidates[m].log_evidence < leastOfContenders(candidates[own].log_evidence) ||
        rivals.size() == kRivals)
      break;
    const Candidate& other = candidates[m].candidate;
    rivals.push_back({other.isForGood() ? other : refinedInterval(without, other, segment_s),
                      screening.alignment(own, m)});
  }
  return rivals;
}

}  // namespace

InItsPlace othersInPlaceOf(std::size_t effect, const Refit& fit, Fits& fits, const LeftOut& left_out) {
  InItsPlace found;
  const Refit rest = fits.without(fit, effect);
  if (!rest.succeeded) return found;
  const Candidate& stated = fit.effects[effect];
  const auto without = modelOf(fits.data(), rest);
  const Screening screening(*without, fits.segments(), left_out);
  const auto& candidates = screening.candidates();
  const std::optional<std::size_t> own = nearestOf(stated, candidates);
  if (!own) return found;
  Alternatives set{{stated}, {0}, {1}, {}};
  std::optional<SizedEffect> like;
  const double lambda = std::pow(sqrtLambda(fit, stated.effect), 2);
  const std::vector<Rival> rivals = rivalsOf(*own, screening, *without, fits.segment_s());
  std::vector<std::vector<Candidate>> sets;
  for (const Rival& rival : rivals) {
    sets.push_back(rest.effects);
    sets.back().push_back(rival.candidate);
  }
  std::vector<Refit> fitted = fits.of(rest, sets);
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    const auto& [other, alignment] = rivals[i];
    Refit& rival = fitted[i];
    if (!rival.succeeded || isListed(other, set)) continue;
    const double difference = fits.logOdds(rival) - fits.logOdds(fit);
    // Where readings contradict each other an effect may be but a way to another minimum, and nothing left of
    // it.
    if (sqrtLambda(rival, other.effect) < kVanished) continue;
    if (difference > 0) {
      found.better = std::move(rival);
      return found;
    }
    found.odds += std::exp(difference);
    const bool is_separable = lambda * (1 - alignment) > kSeparable;
    if (difference < -(is_separable ? kExcluded : kSeparable)) continue;
    set.candidates.push_back(other);
    set.log_odds.push_back(difference);
    set.alignment.push_back(alignment);
    if (!like) like = sized(rival, other);
  }
  if (!like) return found;
  try {
    set.advice = adviseManoeuvre(fits.data(), *without, fit.estimate.state, rest.estimate.state.effects,
                                 sized(fit, stated), *like, fits.noise());
  } catch (const std::runtime_error&) {
    // A manoeuvre in which nothing holds the path tells nothing apart.
  }
  found.set = std::move(set);
  return found;
}

bool isAnotherSameEverywhere(const Alternatives& set, std::size_t effect, const Refit& fit, Fits& fits) {
  return std::any_of(set.candidates.begin() + 1, set.candidates.end(), [&](const Candidate& other) {
    std::vector<Candidate> effects = fit.effects;
    effects[effect] = other;
    Refit rival = fits.of(fit, effects);
    if (!rival.succeeded) return false;
    rival.model = modelOf(fits.data(), rival);
    return !hasFailed(interactionTests(rival, other));
  });
}

}  // namespace fathom
