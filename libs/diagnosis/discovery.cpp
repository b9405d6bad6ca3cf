#include "diagnosis/discovery.h"

#include <algorithm>

namespace fathom {
namespace {

constexpr double kDiscovery = 4, kDiscoveryOfLightOrPart = 5, kDiscoveryOfLightForAPart = 6;

}  // namespace

double discoveryOf(const Candidate& effect) {
  const bool is_light = allEffects()[effect.effect].text.channel == EffectChannel::image;
  if (effect.isForGood()) return is_light ? kDiscoveryOfLightOrPart : kDiscovery;
  return is_light ? kDiscoveryOfLightForAPart : kDiscoveryOfLightOrPart;
}

double discoveryOf(const Refit& fit) {
  double least = kDiscoveryOfLightForAPart;
  for (const Candidate& effect : fit.effects) least = std::min(least, discoveryOf(effect));
  return least;
}

bool isLasting(const Refit& fit) {
  return std::any_of(fit.effects.begin(), fit.effects.end(),
                     [](const Candidate& effect) { return effect.isForGood(); });
}

bool isLarge(const Refit& fit, const Refit& fewer, double discovery) {
  return 2 * (fewer.cost - fit.cost) >= discovery * discovery;
}

bool isLarge(const Refit& fit, const Refit& before) { return isLarge(fit, before, discoveryOf(fit)); }

}  // namespace fathom
