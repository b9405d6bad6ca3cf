#include "decoys.h"

#include <algorithm>

namespace fathom::proof {
namespace {

/// lambda (1 - |c|) up to which an effect is tempting.
constexpr double kTempting = 15;
/// Larger than that nobody expects an effect, so it tempts nobody.
constexpr double kPlausible_sigmas = 3;

}  // namespace

std::vector<Decoy> decoysOn(const PlannedDive& dive, double sqrt_lambda, std::uint64_t seed) {
  const bool range_goes_with_time = dive.json.at("manoeuvre") == "closing";
  std::vector<Decoy> decoys;
  const auto add = [&](const Hidden& one) {
    const auto hidden = ofSize(one, dive, sqrt_lambda);
    if (!hidden) return;
    const auto tempts = [&](const Rival& rival) {
      return rival.prior_sigmas <= kPlausible_sigmas &&
             (!range_goes_with_time || rival.candidate.isForGood() != hidden->candidate.isForGood());
    };
    const ProofCase::Effect described = describedEffect(*hidden, *dive.resolution, tempts);
    if (described.nearest < kTempting) decoys.push_back({*hidden, described});
  };
  for (const EffectInfo& effect : allEffects()) {
    if (!canHide(effect, dive)) continue;
    Random random = Random::stream(seed, 8000 + effect.index);
    const Hidden one = madeEffect(effect, dive, random);
    add(one);
    if (range_goes_with_time && one.candidate.isForGood())
      add(test::activeDuring(one, {dive.duration_s * random.uniform(0.3, 0.6), dive.duration_s}));
  }
  std::stable_sort(decoys.begin(), decoys.end(),
                   [](const Decoy& a, const Decoy& b) { return a.described.nearest < b.described.nearest; });
  return decoys;
}

}  // namespace fathom::proof
