#include "diagnosis/fits.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "core/parallel.h"
#include "core/text.h"
#include "diagnosis/allowance.h"
#include "diagnosis/constants.h"
#include "diagnosis/onset.h"

namespace fathom {
namespace {

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

std::vector<Candidate> allBut(std::size_t one, std::vector<Candidate> effects) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(one));
  return effects;
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

double Fits::gainOf(const Refit& fit) const {
  return std::min(fit.weight.log_evidence - nominal_.weight.log_evidence, fit.weight.log_bayes_factor);
}

double Fits::logOdds(const Refit& fit) const {
  if (!fit.succeeded) return -1e300;
  double odds = gainOf(fit);
  for (const Candidate& effect : fit.effects) odds += prior_.logOf(effect);
  return odds;
}

std::optional<Refit> Fits::bestOf(std::vector<Refit> all) const {
  const auto best = std::max_element(all.begin(), all.end(),
                                     [&](const Refit& a, const Refit& b) { return logOdds(a) < logOdds(b); });
  return best == all.end() ? std::nullopt : std::optional(std::move(*best));
}

std::vector<Refit> Fits::of(const Refit& from, const std::vector<std::vector<Candidate>>& sets) {
  std::vector<Asked> all;
  for (const std::vector<Candidate>& effects : sets) all.push_back({&from, effects});
  return of(all);
}

std::vector<Refit> Fits::of(const std::vector<Asked>& all) {
  std::vector<Refit*> fits;
  std::vector<std::size_t> left;
  for (const Asked& one : all) {
    if (one.effects.empty()) {
      fits.push_back(&nominal_);
      continue;
    }
    const auto [it, is_new] = fitted_.try_emplace(keyOf(one.effects));
    if (is_new) left.push_back(fits.size());
    it->second.asked = ++asked_;
    fits.push_back(&it->second.fit);
  }
  parallelFor(left.size(), [&](std::size_t i) {
    const Asked& one = all[left[i]];
    *fits[left[i]] = refit(data_, *one.from, base_, one.effects, one.from->noise,
                           left.size() > kKeptModels ? Model::none : Model::kept);
  });
  letModelsGo();
  std::vector<Refit> copies;
  for (const Refit* fit : fits) copies.push_back(*fit);
  return copies;
}

void Fits::letModelsGo() {
  std::vector<Cached*> kept;
  for (auto& [name, cached] : fitted_)
    if (cached.fit.model) kept.push_back(&cached);
  std::sort(kept.begin(), kept.end(), [](const Cached* a, const Cached* b) { return a->asked > b->asked; });
  for (std::size_t i = kKeptModels; i < kept.size(); ++i) kept[i]->fit.model.reset();
}

Refit Fits::without(const Refit& from, std::size_t one) { return of(from, allBut(one, from.effects)); }

void Fits::makeWithoutEach(const Refit& fit) {
  std::vector<std::vector<Candidate>> rests;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) rests.push_back(allBut(i, fit.effects));
  of(fit, rests);
}

Candidate Fits::settledOf(const Refit& rest, const Candidate& effect) const {
  const auto model = modelOf(data_, rest);
  return effect.isForGood() ? bestInterval(*model, effect, segments_ / 3)
                            : refinedInterval(*model, withPauses(*model, effect, segments_), segment_s());
}

std::vector<Refit> Fits::settled(std::vector<Refit> all) {
  std::vector<std::vector<Candidate>> effects;
  std::size_t most = 0;
  for (const Refit& fit : all) {
    effects.push_back(fit.effects);
    most = std::max(most, fit.effects.size());
  }
  // One effect of each after the other, beside the others as they have become.
  for (std::size_t e = 0; e < most; ++e) {
    std::vector<std::size_t> whose;
    std::vector<Asked> rests;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (e >= effects[i].size()) continue;
      // What lasts was screened with intervals already, but for what is of one marker.
      if (effects[i][e].isForGood() && !effects[i][e].marker_id) continue;
      whose.push_back(i);
      rests.push_back({&all[i], allBut(e, effects[i])});
    }
    const std::vector<Refit> fitted = of(rests);
    parallelFor(whose.size(), [&](std::size_t k) {
      Candidate& effect = effects[whose[k]][e];
      if (fitted[k].succeeded) effect = settledOf(fitted[k], effect);
    });
  }
  std::vector<Asked> asked;
  for (std::size_t i = 0; i < all.size(); ++i) asked.push_back({&all[i], effects[i]});
  std::vector<Refit> again = of(asked);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (logOdds(again[i]) > logOdds(all[i])) all[i] = std::move(again[i]);
  return all;
}

/// To first order an effect that lasts, and is far from linear, is not far behind its best part.
bool Fits::mayLast(const Refit& fit, std::size_t effect) {
  const Refit rest = without(fit, effect);
  if (!rest.succeeded) return true;
  const std::vector<double> evidence =
      evidencesOf(*modelOf(data_, rest), {fit.effects[effect], lasting(fit.effects[effect])});
  return evidence[1] > kMayLast * evidence[0];
}

Refit Fits::lastingWhereBetter(Refit fit) {
  for (std::size_t i = 0; i < fit.effects.size();) {
    std::vector<Candidate> all = fit.effects, lasting;
    all[i].active_s = {};
    if (all == fit.effects || !mayLast(fit, i)) {
      ++i;
      continue;
    }
    std::copy_if(all.begin(), all.end(), std::back_inserter(lasting),
                 [](const Candidate& effect) { return effect.isForGood(); });
    ++i;
    for (Refit& longer : of(fit, {all, lasting}))
      if (logOdds(longer) > logOdds(fit)) {
        fit = onlyNeeded(std::move(longer));
        i = 0;
      }
  }
  return fit;
}

double Fits::thresholdBeside() const { return std::max(threshold_, kExcluded); }

Refit Fits::onlyNeeded(Refit fit) {
  for (std::size_t i = 0; fit.effects.size() > 1 && i < fit.effects.size();) {
    if (sqrtLambda(fit, fit.effects[i].effect) > kPlainlyNeeded) {
      ++i;
      continue;
    }
    Refit less = without(fit, i);
    if (!less.succeeded || logOdds(fit) >= logOdds(less) + thresholdBeside()) {
      ++i;
      continue;
    }
    fit = std::move(less);
    i = 0;
  }
  return fit;
}

}  // namespace fathom
