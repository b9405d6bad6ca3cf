#include "diagnosis/contenders.h"

#include <algorithm>
#include <map>

#include "diagnosis/constants.h"
#include "diagnosis/fits.h"

namespace fathom {
namespace {

std::vector<TestedSet> likeliestSets(const Screening& screening, std::size_t size, double threshold,
                                     bool camera_alone) {
  const std::vector<TestedSet> sets = screening.bestSets(size, kLooked, threshold);
  const auto isSameBut = [&](std::size_t a, std::size_t b) {
    return isSameButTime(screening.candidates()[a].candidate, screening.candidates()[b].candidate);
  };
  std::vector<TestedSet> tried;
  for (const TestedSet& set : sets) {
    if (set.log_evidence < leastOfContenders(sets.front().log_evidence) || tried.size() == kContenders) break;
    if (!camera_alone && set.log_evidence < threshold - kUnderestimated) break;
    // What adds nothing to one that was tried is looked for again once that one is in the model; and when
    // they are there is settled later.
    const auto isOneOf = [&](const TestedSet& other) {
      return std::includes(set.members.begin(), set.members.end(), other.members.begin(),
                           other.members.end()) ||
             (!camera_alone && std::is_permutation(set.members.begin(), set.members.end(),
                                                   other.members.begin(), other.members.end(), isSameBut));
    };
    if (std::none_of(tried.begin(), tried.end(), isOneOf)) tried.push_back(set);
  }
  return tried;
}

/// Of a camera alone, whole pixels off perhaps: whatever lasts.
std::vector<Candidate> allThatLast(const Screening& screening) {
  std::vector<Candidate> lasting;
  for (const TestedCandidate& tested : screening.candidates())
    if (tested.candidate.isForGood() && !tested.candidate.marker_id) lasting.push_back(tested.candidate);
  return lasting;
}

/// What comes near to an effect that is far from linear, as a peak's time and width always are.
std::vector<Candidate> farFromLinear(const Screening& screening) {
  double largest = 0;
  for (const TestedCandidate& tested : screening.candidates())
    largest = std::max(largest, tested.log_evidence);
  std::map<std::size_t, const TestedCandidate*> nearest;  // by effect
  for (const TestedCandidate& tested : screening.candidates()) {
    const bool is_far = largest >= kFarFromLinear || tested.candidate.peak;
    if (!is_far || tested.log_evidence < kFarShare * largest) continue;
    const TestedCandidate*& own = nearest[tested.candidate.effect];
    if (own == nullptr || tested.log_evidence > own->log_evidence) own = &tested;
  }
  std::vector<Candidate> far;
  for (const auto& [effect, tested] : nearest) {
    far.push_back(tested->candidate);
    if (tested->candidate.active_s == Interval{}) continue;
    // What lasts may do too much to first order where it is largest: then a part of it seems to fit better.
    far.push_back(tested->candidate);
    far.back().active_s = {};
  }
  return far;
}

}  // namespace

std::vector<Contender> contendersOf(const Screening& screening, std::size_t size, double threshold,
                                    bool camera_alone) {
  std::vector<Contender> contenders;
  for (const TestedSet& set : likeliestSets(screening, size, threshold, camera_alone)) {
    Contender& own = contenders.emplace_back();
    for (const std::size_t m : set.members) own.effects.push_back(screening.candidates()[m].candidate);
    own.foretold = set.log_evidence;
  }
  for (const Candidate& alone : camera_alone ? allThatLast(screening) : farFromLinear(screening))
    contenders.push_back({{alone}});
  return contenders;
}

}  // namespace fathom
