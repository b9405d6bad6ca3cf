#include "diagnosis/fits.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "core/parallel.h"
#include "core/text.h"
#include "diagnosis/onset.h"

namespace fathom {
namespace {

constexpr double kContenderMargin = 8;  // ln odds to first order, plus a share of the largest:
constexpr double kContenderShare = 0.25;
constexpr std::size_t kKept = 8;  // models

/// The same for the same effects, in whatever order.
std::string keyOf(const std::vector<Candidate>& effects) {
  std::set<std::string> names;
  for (const Candidate& effect : effects) {
    std::string name =
        nameOf(effect) + print(" %.17g %.17g %.17g", effect.time_s.value_or(0),
                               effect.peak.value_or(Peak{}).time_s, effect.peak.value_or(Peak{}).width_s);
    for (const auto& [from_s, to_s] : effect.active_s.parts()) name += print(" %.17g %.17g", from_s, to_s);
    names.insert(name);
  }
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
  prior_ = PriorOdds(nominal_.model->linear(), segments_);
  noise_ = noise;
  fitted_.clear();
}

double Fits::segment_s() const { return (data_.last_s - data_.first_s) / segments_; }

double Fits::logOdds(const Refit& fit) const {
  if (!fit.succeeded) return -1e300;
  double odds = fit.weight.log_evidence - nominal_.weight.log_evidence;
  for (const Candidate& effect : fit.effects) odds += prior_.logOf(effect);
  return odds;
}

std::vector<Refit> Fits::of(const Refit& from, const std::vector<std::vector<Candidate>>& sets) {
  const std::size_t before = asked_;
  std::vector<Refit*> all;
  std::vector<std::size_t> left;
  for (const std::vector<Candidate>& effects : sets) {
    const auto [it, is_new] = fitted_.try_emplace(keyOf(effects));
    Cached& cached = it->second;
    // Once for each set, should it be among these twice.
    if (is_new || (cached.asked <= before && cached.fit.succeeded && !cached.fit.model))
      left.push_back(all.size());
    cached.asked = ++asked_;
    all.push_back(&cached.fit);
  }
  parallelFor(left.size(), [&](std::size_t i) {
    *all[left[i]] = refit(data_, from.estimate, base_, sets[left[i]], from.model->noise());
  });
  std::vector<Refit> fits;
  for (const Refit* fit : all) fits.push_back(*fit);
  forgetModels();
  return fits;
}

void Fits::forgetModels() {
  if (!data_.hasMotion()) return;  // forEach() is to see them
  std::vector<Cached*> kept;
  for (auto& [name, cached] : fitted_)
    if (cached.fit.model) kept.push_back(&cached);
  std::sort(kept.begin(), kept.end(), [](const Cached* a, const Cached* b) { return a->asked > b->asked; });
  for (std::size_t i = kKept; i < kept.size(); ++i) kept[i]->fit.model.reset();
}

Refit Fits::without(const Refit& from, std::vector<Candidate> effects, std::size_t one) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(one));
  return effects.empty() ? nominal_ : of(from, effects);
}

Refit Fits::settled(Refit fit) {
  std::vector<Candidate> effects = fit.effects;
  bool changed = false;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const bool lasting = effects[i].isForGood();
    if (lasting && !effects[i].marker_id) continue;  // screened with intervals already
    const Refit rest = without(fit, effects, i);
    if (!rest.succeeded) continue;
    const Candidate better =
        lasting ? bestInterval(*rest.model, effects[i], segments_ / 3)
                : refinedInterval(*rest.model, withPauses(*rest.model, effects[i], segments_), segment_s());
    changed = changed || !(better == effects[i]);
    effects[i] = better;
  }
  if (!changed) return fit;
  Refit again = of(fit, effects);
  return logOdds(again) > logOdds(fit) ? again : fit;
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
      if (logOdds(longer) > logOdds(fit)) {
        fit = onlyNeeded(std::move(longer));
        i = 0;
      }
  }
  return fit;
}

Refit Fits::onlyNeeded(Refit fit) {
  for (std::size_t i = 0; fit.effects.size() > 1 && i < fit.effects.size();) {
    Refit less = without(fit, i);
    if (!less.succeeded || logOdds(fit) >= logOdds(less) + threshold_) {
      ++i;
      continue;
    }
    fit = std::move(less);
    i = 0;
  }
  return fit;
}

}  // namespace fathom
