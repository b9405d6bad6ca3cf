#include "diagnosis/confirmation.h"

#include <algorithm>
#include <set>

#include "core/text.h"
#include "diagnosis/constants.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

/// The largest of a fit's effects whose error one of them may be; itself, where that is none.
std::size_t largestThatErrsAs(const Refit& fit, std::size_t effect) {
  std::size_t largest = effect;
  for (std::size_t i = 0; i < fit.effects.size(); ++i)
    if (mayErrAs(fit.effects[i], fit.effects[effect]) &&
        sqrtLambda(fit, fit.effects[i].effect) > sqrtLambda(fit, fit.effects[largest].effect))
      largest = i;
  return largest;
}

bool lastsLong(const Candidate& effect, const BatchData& data) {
  if (effect.peak) return false;
  const double least_s = kUnseenShare * (data.last_s - data.first_s);
  if (effect.time_s) return *effect.time_s - data.first_s > least_s && data.last_s - *effect.time_s > least_s;
  const double on_s =
      std::min(effect.active_s.to_s, data.last_s) - std::max(effect.active_s.from_s, data.first_s);
  return on_s > least_s;
}

bool isConfirmed(const Refit& fit, std::size_t effect, const HeldOutGain& held, Fits& fits) {
  const double seen = held.by_effect[effect], expected = held.expected_by_effect[effect];
  const bool lasts = lastsLong(fit.effects[effect], fits.data());
  if (lasts && seen > std::max(kUnseen, kConfirmed * expected)) return true;
  const Refit rest = fits.without(fit, effect);
  const double gain = rest.succeeded ? fits.gainOf(fit) - fits.gainOf(rest) : 0;
  return expected >= kShownAtAll * gain
             ? seen > leastSeen(std::min(gain, expected), held.scatter_by_effect[effect])
             : gain > kUnseen && lasts;
}

/// Why an effect is not named though it fits; empty where it is.
std::string whyNot(const Refit& fit, std::size_t effect, const HeldOutGain& held, Fits& fits) {
  if (!isConfirmed(fit, effect, held, fits)) return "not stretches that it was not fitted to";
  const std::size_t larger = largestThatErrsAs(fit, effect);
  const double share =
      sqrtLambda(fit, fit.effects[effect].effect) / sqrtLambda(fit, fit.effects[larger].effect);
  if (share >= kModelError) return "";
  return print("it is %.2g %% of ", 100 * share) + nameOf(fit.effects[larger]) +
         ", and no model of that is so exact";
}

/// Those effects that are not named, each with its remark. None of them is tried again: where it was for a
/// part, for a part, and after that not at all.
std::set<std::size_t> unconfirmedOf(const Refit& fit, const Confirmation& by) {
  const HeldOutGain held = heldOut(by.fits, fit, by.held_out).gain;
  std::set<std::size_t> unconfirmed;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const Candidate& effect = fit.effects[i];
    const std::string why_not = whyNot(fit, i, held, by.fits);
    if (why_not.empty()) continue;
    unconfirmed.insert(i);
    const bool is_last = effect.isForGood() || by.left_out.parts.contains(effect.effect);
    (is_last ? by.left_out.all : by.left_out.parts).insert(effect.effect);
    if (effect.active_s != Interval{} && !lastsLong(effect, by.fits.data()))
      by.left_out.during.push_back(effect.active_s);
    by.remarks.push_back(nameOf(effect) + " would fit, but " + why_not);
  }
  return unconfirmed;
}

}  // namespace

bool mayErrAs(const Candidate& larger, const Candidate& effect) {
  const EffectChannel its = allEffects()[larger.effect].text.channel,
                      own = allEffects()[effect.effect].text.channel;
  return its == own || (its == EffectChannel::image && own == EffectChannel::marker_geometry &&
                        effect.active_s.to_s < Interval::kForever_s);
}

double leastSeen(double expected, double scatter) {
  return std::min(kConfirmed * expected, std::max(0.0, expected - kUsualSigmas * scatter));
}

HeldOutResult heldOut(const Fits& fits, const Refit& fit, const HeldOutOptions& options) {
  NoiseModel noise = fits.noise();
  noise.apart = fit.noise.apart;
  BatchEstimate at = fit.estimate;
  // Light is linear about what budget and effects made of it; all else where the effects are as they were
  // found.
  if (!fit.linearized_at.light.empty()) at.state = fit.linearized_at;
  const Linearization linear = linearize(fits.data(), *problemAt(fits.data(), at, fit.options));
  // What is drawn for each image scatters as it was found to, wherever that is linear.
  for (const EffectEstimate& drawn : fit.estimates)
    if (drawn.image >= 0)
      at.state.effects.values[drawn.scalar] = fit.estimate.state.effects.values[drawn.scalar];
  return holdOut(linear, fit.effects, at.state, noise, fits.data(), options);
}

Refit confirmed(Refit fit, const std::vector<Candidate>& already, const Confirmation& by) {
  while (fit.succeeded && fit.effects != already) {
    const std::set<std::size_t> unconfirmed = unconfirmedOf(fit, by);
    if (unconfirmed.empty()) break;
    std::vector<Candidate> kept;
    for (std::size_t i = 0; i < fit.effects.size(); ++i)
      if (!unconfirmed.contains(i)) kept.push_back(fit.effects[i]);
    fit = by.fits.onlyNeeded(by.fits.of(fit, kept));
  }
  return fit;
}

}  // namespace fathom
