#include "diagnosis/fits.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "core/parallel.h"
#include "core/text.h"
#include "diagnosis/discovery.h"
#include "diagnosis/onset.h"
#include "diagnosis/screening.h"

namespace fathom {
namespace {

constexpr double kContenderMargin = 8;  // ln p to first order, plus a share of the largest:
constexpr double kContenderShare = 0.25;

/// The same for the same effects, in whatever order.
std::string keyOf(const std::vector<Candidate>& effects) {
  std::set<std::string> names;
  for (const Candidate& effect : effects)
    names.insert(nameOf(effect) + print(" %.17g %.17g %.17g %.17g %.17g", effect.time_s.value_or(0),
                                        effect.active_s.from_s, effect.active_s.to_s,
                                        effect.peak.value_or(Peak{}).time_s,
                                        effect.peak.value_or(Peak{}).width_s));
  std::string key;
  for (const std::string& name : names) key += name + "\n";
  return key;
}

}  // namespace

double leastOfContenders(double largest) {
  return largest - kContenderMargin - kContenderShare * std::abs(largest);
}

void Fits::beginWith(Refit nominal, BatchOptions base, const NoiseModel& noise) {
  nominal_ = std::move(nominal);
  base_ = std::move(base);
  noise_ = noise;
  fitted_.clear();
}

double Fits::segment_s() const { return (data_.last_s - data_.first_s) / segments_; }

double Fits::worth(const Refit& fit) const {
  if (!fit.succeeded) return -1e300;
  double odds = kLogOdds * (static_cast<double>(fit.effects.size()) - 1);
  for (const Candidate& effect : fit.effects) odds -= logPriorOf(effect, segments_);
  return supportOver(fit, nominal_) - odds;
}

std::vector<Refit> Fits::of(const Refit& from, const std::vector<std::vector<Candidate>>& sets) {
  std::vector<Refit*> all;
  std::vector<std::size_t> left;
  for (const std::vector<Candidate>& effects : sets) {
    const auto [it, is_new] = fitted_.try_emplace(keyOf(effects));
    if (is_new) left.push_back(all.size());
    all.push_back(&it->second);
  }
  parallelFor(left.size(), [&](std::size_t i) {
    *all[left[i]] = refit(data_, from.estimate, base_, sets[left[i]], noise_);
  });
  std::vector<Refit> fits;
  for (const Refit* fit : all) fits.push_back(*fit);
  return fits;
}

Refit Fits::without(const Refit& from, std::vector<Candidate> effects, std::size_t one) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(one));
  return effects.empty() ? nominal_ : of(from, effects);
}

Refit Fits::settled(Refit fit) {
  std::vector<Candidate> effects = fit.effects;
  bool changed = false;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const Refit rest = without(fit, effects, i);
    if (!rest.succeeded) continue;
    const bool lasting = effects[i].isForGood();
    if (lasting && !effects[i].marker_id) continue;  // screened with intervals already
    const Candidate better = lasting ? bestInterval(*rest.model, effects[i], segments_ / 3)
                                     : refinedInterval(*rest.model, effects[i], segment_s());
    changed = changed || !(better == effects[i]);
    effects[i] = better;
  }
  if (!changed) return fit;
  Refit again = of(fit, effects);
  return worth(again) > worth(fit) ? again : fit;
}

Refit Fits::lastingWhereBetter(Refit fit) {
  for (std::size_t i = 0; i < fit.effects.size();) {
    std::vector<Candidate> all = fit.effects, lasting;
    all[i].active_s = {};
    std::copy_if(all.begin(), all.end(), std::back_inserter(lasting),
                 [](const Candidate& effect) { return effect.isForGood(); });
    ++i;
    if (all == fit.effects) continue;
    for (Refit& longer : of(fit, {all, lasting}))
      if (worth(longer) > worth(fit)) {
        fit = onlyNeeded(std::move(longer));
        i = 0;
      }
  }
  return fit;
}

/// Not where the others make it superfluous, where it is too small to be named, where the readings do not ask
/// for it, only the prior of another one, which is far larger than expected, or where it moves readings by
/// less than their own bias may be.
bool Fits::isNeeded(const Refit& fit, const Refit& less, const Candidate& effect) const {
  const double discovery = discoveryOf(effect);
  return sqrtLambda(fit, effect.effect) >= discovery && isLarge(fit, less, discovery) &&
         worth(less) < worth(fit) && isBeyondBias(fit, less, effect);
}

Refit Fits::onlyNeeded(Refit fit) {
  for (std::size_t i = 0; fit.effects.size() > 1 && i < fit.effects.size();) {
    Refit less = without(fit, i);
    if (!less.succeeded || isNeeded(fit, less, fit.effects[i])) {
      ++i;
      continue;
    }
    fit = std::move(less);
    i = 0;
  }
  return fit;
}

}  // namespace fathom
