#include "diagnosis/diagnosis.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "core/progress.h"
#include "core/text.h"
#include "diagnosis/nominal.h"
#include "diagnosis/onset.h"
#include "diagnosis/verdict.h"

namespace fathom {
namespace {

constexpr double kLogOdds = 8.0;        // ln of the odds against an effect besides another, before looking
constexpr double kSameSupport = 2.7;    // half of the 5.4 by which the right one loses once in a hundred
constexpr double kContenderMargin = 8;  // ln p to first order, plus a share of the best's:
constexpr double kContenderShare = 0.25;
constexpr double kFarFromLinear = 100;  // support from which on an effect may be
constexpr double kFarShare = 0.3;       // of the largest support: what may be right then
constexpr std::size_t kLooked = 40, kContenders = 5, kRivals = 4;
// sqrt(lambda) from which on an effect is named: noise has tails, too, and what a panel and a lens do to
// light is known less well than that; what is on for a part can be made to fit anything, and of light, both.
constexpr double kDiscovery = 4, kDiscoveryOfLightOrPart = 5, kDiscoveryOfLightForAPart = 6;
constexpr double kLessNoise = 0.9;  // times the noise taken before: less than chance
// Of the likelihood that an effect gains, on stretches that it was not fitted to. Where these could not show
// a tenth of it, since poses follow it there, it has to gain that much where it was fitted, and over more
// than a few images: that share of the recording.
constexpr double kConfirmed = 0.3, kShownAtAll = 0.1, kUnseen = 50, kUnseenShare = 0.25;

/// To compare what a camera by itself shows: its noise and the markers' scatter, multiplied.
double cameraNoise(const NoiseModel& noise) {
  double product = noise.markers.largest_m() > 0 ? noise.markers.rms_m() : 1;
  for (const BatchChannel channel : {BatchChannel::markers, BatchChannel::tie_points, BatchChannel::pixels})
    product *= noise.of(channel).independentScale();
  return product;
}

double discoveryOf(const Candidate& effect) {
  const bool is_light = allEffects()[effect.effect].text.channel == EffectChannel::image;
  if (effect.isForGood()) return is_light ? kDiscoveryOfLightOrPart : kDiscovery;
  return is_light ? kDiscoveryOfLightForAPart : kDiscoveryOfLightOrPart;
}

/// The least of its effects.
double discoveryOf(const Refit& fit) {
  double least = kDiscoveryOfLightForAPart;
  for (const Candidate& effect : fit.effects) least = std::min(least, discoveryOf(effect));
  return least;
}

bool isLasting(const Refit& fit) {
  return std::any_of(fit.effects.begin(), fit.effects.end(),
                     [](const Candidate& effect) { return effect.isForGood(); });
}

/// Whether what one fit has beside another is large enough for an effect to be named.
bool isLarge(const Refit& fit, const Refit& fewer, double discovery) {
  return 2 * (fewer.cost - fit.cost) >= discovery * discovery;
}

/// Of the support of what may turn out to be the best, beside the largest.
double leastOfContenders(double largest) {
  return largest - kContenderMargin - kContenderShare * std::abs(largest);
}

/// Whether anything that a fit has found is.
bool isLarge(const Refit& fit, const Refit& before) { return isLarge(fit, before, discoveryOf(fit)); }

bool isQuieter(const NoiseModel& shown, const NoiseModel& before) {
  for (std::size_t c = 0; c < before.channels.size(); ++c)
    if (shown.channels[c].independentScale() < kLessNoise * before.channels[c].independentScale())
      return true;
  return shown.markers.in_face_m < kLessNoise * before.markers.in_face_m ||
         shown.markers.off_face_m < kLessNoise * before.markers.off_face_m ||
         shown.light_scatter < kLessNoise * before.light_scatter ||
         shown.print.black < kLessNoise * before.print.black ||
         shown.print.white < kLessNoise * before.print.white ||
         shown.print.body < kLessNoise * before.print.body ||
         shown.print.parts < kLessNoise * before.print.parts;
}

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

/// The course of a diagnosis.
class Course {
 public:
  Course(const BatchInput& input, const DiagnosisOptions& options)
      : data_(input.data), start_(input.start), options_(options) {}

  Diagnosis run() {
    if (!estimateNominal()) return std::move(diagnosis_);
    locate();
    attribute();
    verify();
    report();
    judge(diagnosis_, nominal_.model->linear(), options_.calibration);
    return std::move(diagnosis_);
  }

 private:
  bool estimateNominal();
  void locate();
  void attribute();
  void verify();
  void report();

  bool insufficient(const std::string& why);
  /// Each set of effects is fitted once, those that are new beside each other.
  std::vector<Refit> fits(const Refit& from, const std::vector<std::vector<Candidate>>& sets);
  Refit fit(const Refit& from, const std::vector<Candidate>& effects) { return fits(from, {effects})[0]; }
  /// Worth of a fit against the nominal one, with the odds against so many effects. (The first is believed by
  /// the alarm: it knows the chance of a false one.)
  double worth(const Refit& fit) const {
    if (!fit.succeeded) return -1e300;
    double odds = oddsAgainst(fit.effects.size());
    for (const Candidate& effect : fit.effects) odds -= logPriorOf(effect, options_.segments);
    return supportOver(fit, nominal_) - odds;
  }
  static double oddsAgainst(std::size_t effects) { return kLogOdds * (static_cast<double>(effects) - 1); }
  double segment_s() const { return (data_.last_s - data_.first_s) / options_.segments; }
  std::optional<Refit> bestOf(const Refit& from, const Screening& screening, std::size_t size);
  std::vector<Candidate> farContenders(const Screening& screening) const;
  Refit settled(Refit fit);
  Refit without(const Refit& from, std::vector<Candidate> effects, std::size_t one);
  Refit without(const Refit& from, std::size_t one) { return without(from, from.effects, one); }
  Refit onlyNeeded(Refit fit);
  bool isNeeded(const Refit& fit, const Refit& less, const Candidate& effect) const;
  bool isBelieved(const Refit& fit, const Looks& looks);
  bool leaveOutUnconfirmed(const Refit& fit);
  void accept(Refit better);
  bool lastsLong(const Candidate& effect) const;
  bool takeNoise(const NoiseModel& shown);
  bool takeLeastNoise();
  /// Its fits are quick.
  bool isCameraAlone() const { return !data_.hasMotion(); }
  HeldOutResult heldOut(const Refit& fit, bool yardsticks) const;
  bool addAlternatives(std::size_t effect);
  FoundEffect describe(std::size_t effect);

  const BatchData& data_;
  const StartPath& start_;
  DiagnosisOptions options_;
  BatchOptions base_;
  Refit nominal_, final_;
  std::set<std::size_t>
      lasting_only_;  // effects of which a part of the recording was tried, and not confirmed
  std::map<std::string, Refit> fitted_;  // by the effects' names
  std::vector<double> confidence_;       // of each effect in the final model
  Diagnosis diagnosis_;
};

std::vector<Refit> Course::fits(const Refit& from, const std::vector<std::vector<Candidate>>& sets) {
  std::vector<Refit*> all;
  std::vector<std::size_t> left;
  for (const std::vector<Candidate>& effects : sets) {
    const auto [it, is_new] = fitted_.try_emplace(keyOf(effects));
    if (is_new) left.push_back(all.size());
    all.push_back(&it->second);
  }
  tbb::parallel_for(std::size_t{0}, left.size(), [&](std::size_t i) {
    *all[left[i]] = refit(data_, from.estimate, base_, sets[left[i]], diagnosis_.noise);
  });
  std::vector<Refit> fits;
  for (const Refit* fit : all) fits.push_back(*fit);
  return fits;
}

bool Course::insufficient(const std::string& why) {
  diagnosis_.verdict = Verdict::insufficient;
  diagnosis_.why = why;
  return false;
}

bool Course::estimateNominal() {
  NominalFit nominal = nominalFit(data_, start_, options_.calibration, options_.seed);
  base_ = nominal.options;
  diagnosis_.noise = nominal.noise;
  if (!nominal.failure.empty()) return insufficient(nominal.failure);
  nominal_ = std::move(nominal.fit);
  final_ = nominal_;
  return true;
}

void Course::locate() { diagnosis_.mismatch = mismatchMaps(*nominal_.model, options_.seed); }

/// Intervals and times to a fraction of a segment, and whether what seems lasting was on for a part only.
Refit Course::settled(Refit fit) {
  std::vector<Candidate> effects = fit.effects;
  bool changed = false;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const Refit rest = without(fit, effects, i);
    if (!rest.succeeded) continue;
    const bool lasting = effects[i].isForGood();
    if (lasting && !effects[i].marker_id) continue;  // screened with intervals already
    const Candidate better = lasting ? bestInterval(*rest.model, effects[i], options_.segments / 3)
                                     : refinedInterval(*rest.model, effects[i], segment_s());
    changed = changed || !(better == effects[i]);
    effects[i] = better;
  }
  if (!changed) return fit;
  Refit again = this->fit(fit, effects);
  return worth(again) > worth(fit) ? again : fit;
}

/// The best set of so many more effects, each contender estimated in full.
std::optional<Refit> Course::bestOf(const Refit& from, const Screening& screening, std::size_t size) {
  const std::vector<TestedSet> sets = screening.bestSets(size, kLooked, kLogOdds);
  std::vector<std::vector<Candidate>> contenders;
  const auto add = [&](const std::vector<Candidate>& more) {
    contenders.push_back(from.effects);
    contenders.back().insert(contenders.back().end(), more.begin(), more.end());
  };
  std::vector<std::vector<std::size_t>> tried;
  for (const TestedSet& set : sets) {
    if (set.support < leastOfContenders(sets.front().support) || tried.size() == kContenders) break;
    // What adds nothing to one that was tried is looked for again once that one is in the model.
    if (std::any_of(tried.begin(), tried.end(), [&](const std::vector<std::size_t>& smaller) {
          return std::includes(set.members.begin(), set.members.end(), smaller.begin(), smaller.end());
        }))
      continue;
    tried.push_back(set.members);
    std::vector<Candidate> members;
    for (const std::size_t m : set.members) members.push_back(screening.candidates()[m].candidate);
    add(members);
  }
  for (const Candidate& alone : farContenders(screening)) add({alone});
  std::optional<Refit> best;
  std::vector<Refit> all = fits(from, contenders);
  double highest = -1e300;
  for (const Refit& refitted : all) highest = std::max(highest, worth(refitted));
  for (Refit& refitted : all) {
    if (!refitted.succeeded || worth(refitted) < leastOfContenders(highest)) continue;
    Refit own = settled(std::move(refitted));
    if (!best || worth(own) > worth(*best)) best = std::move(own);
  }
  return best;
}

/// What the first order tells little of, to be tried by itself: of a camera alone, whole pixels off perhaps,
/// whatever lasts; elsewhere what comes near to an effect that is far from linear, as a peak's time and width
/// always are.
std::vector<Candidate> Course::farContenders(const Screening& screening) const {
  std::vector<Candidate> contenders;
  if (isCameraAlone()) {
    for (const TestedCandidate& tested : screening.candidates())
      if (tested.candidate.isForGood() && !tested.candidate.marker_id) contenders.push_back(tested.candidate);
    return contenders;
  }
  double largest = 0;
  for (const TestedCandidate& tested : screening.candidates()) largest = std::max(largest, tested.support);
  std::map<std::size_t, const TestedCandidate*> nearest;  // by effect
  for (const TestedCandidate& tested : screening.candidates()) {
    const bool is_far = largest >= kFarFromLinear || tested.candidate.peak;
    if (!is_far || tested.support < kFarShare * largest) continue;
    const TestedCandidate*& own = nearest[tested.candidate.effect];
    if (own == nullptr || tested.support > own->support) own = &tested;
  }
  for (const auto& [effect, tested] : nearest) contenders.push_back(tested->candidate);
  return contenders;
}

/// Refitted with one effect fewer.
Refit Course::without(const Refit& from, std::vector<Candidate> effects, std::size_t one) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(one));
  return effects.empty() ? nominal_ : fit(from, effects);
}

/// Not where the others make it superfluous, where it is too small to be named, where the readings do not ask
/// for it, only the prior of another one, which is far larger than expected, or where it moves readings by
/// less than their own bias may be.
bool Course::isNeeded(const Refit& fit, const Refit& less, const Candidate& effect) const {
  const double discovery = discoveryOf(effect);
  return sqrtLambda(fit, effect.effect) >= discovery && isLarge(fit, less, discovery) &&
         worth(less) < worth(fit) && isBeyondBias(fit, less, effect);
}

Refit Course::onlyNeeded(Refit fit) {
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

void Course::attribute() {
  Progress progress("trying effects");
  for (int round = 0; final_.effects.size() < options_.max_effects; ++round) {
    progress.update(static_cast<double>(final_.effects.size()) / static_cast<double>(options_.max_effects));
    const Screening screening(*final_.model, options_.segments, lasting_only_);
    const Looks looks = screening.independentLooks(options_.seed);
    const auto alarmBy = [&](const TestedCandidate& tested) {
      return alarmOf(tested.log_p, tested.candidate.isForGood(), looks);
    };
    const auto first = std::min_element(
        screening.candidates().begin(), screening.candidates().end(),
        [&](const TestedCandidate& a, const TestedCandidate& b) { return alarmBy(a) < alarmBy(b); });
    if (first == screening.candidates().end()) break;
    const double alarm = alarmBy(*first);
    if (final_.effects.empty()) {
      diagnosis_.alarm_p = alarm;
      diagnosis_.most_improbable = nameOf(first->candidate);
    }
    if (round == 0) {
      diagnosis_.tested = screening.candidates();
      std::stable_sort(
          diagnosis_.tested.begin(), diagnosis_.tested.end(),
          [](const TestedCandidate& a, const TestedCandidate& b) { return a.support > b.support; });
    }
    if (alarm > options_.false_alarm) break;
    const std::size_t left = options_.max_effects - final_.effects.size();
    std::optional<Refit> best = bestOf(final_, screening, left);
    if (!best) break;
    if (takeLeastNoise()) continue;
    Refit better = onlyNeeded(std::move(*best));
    if (!final_.effects.empty() && worth(better) <= worth(final_)) break;
    if (!isBelieved(better, looks)) break;
    if (leaveOutUnconfirmed(better)) continue;
    accept(std::move(better));
  }
  confidence_.assign(final_.effects.size(), 1 - diagnosis_.alarm_p);
  for (std::size_t i = 0; i < final_.effects.size();)
    if (!addAlternatives(i)) ++i;
}

/// What has raised the alarm may be another than what is best supported, or explain less once refitted.
bool Course::isBelieved(const Refit& fit, const Looks& looks) {
  const double alarm = alarmOf(-supportOver(fit, final_), isLasting(fit), looks);
  const Candidate& first = fit.effects.front();
  const bool alone = fit.effects.size() == 1;
  const bool is_large =
      isLarge(fit, final_) && (!alone || sqrtLambda(fit, first.effect) >= discoveryOf(first));
  if (is_large && alarm <= options_.false_alarm) {
    if (!alone || isBeyondBias(fit, nominal_, first)) return true;
    diagnosis_.is_within_bias = true;
    return false;
  }
  if (final_.effects.empty()) {
    diagnosis_.alarm_p = std::max(diagnosis_.alarm_p, alarm);
    diagnosis_.most_improbable = nameOf(first);
  }
  return false;
}

bool Course::lastsLong(const Candidate& effect) const {
  if (effect.time_s || effect.peak) return false;
  const double on_s =
      std::min(effect.active_s.to_s, data_.last_s) - std::max(effect.active_s.from_s, data_.first_s);
  return on_s > kUnseenShare * (data_.last_s - data_.first_s);
}

/// An effect for a part of the recording can be made to fit any few images that are a little off: it must
/// show on stretches that it was not fitted to. One that does not is not tried again.
bool Course::leaveOutUnconfirmed(const Refit& fit) {
  const auto isPart = [](const Candidate& effect) { return !effect.isForGood(); };
  if (std::none_of(fit.effects.begin(), fit.effects.end(), isPart)) return false;
  const HeldOutResult held = heldOut(fit, false);
  bool any = false;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const Refit rest = without(fit, i);
    const double gain = rest.succeeded ? rest.cost - fit.cost : 0;
    const bool shown = held.gain.expected_by_effect[i] >= kShownAtAll * gain
                           ? held.gain.by_effect[i] > kConfirmed * gain
                           : gain > kUnseen && lastsLong(fit.effects[i]);
    if (!isPart(fit.effects[i]) || shown) continue;
    any = lasting_only_.insert(fit.effects[i].effect).second || any;
    diagnosis_.remarks.push_back(nameOf(fit.effects[i]) +
                                 " would fit, but not stretches that it was not fitted to");
  }
  return any;
}

/// What a large effect does beyond the first order was taken for noise as long as it was not in the model:
/// where noise now shows to be less, everything is fitted again with it, and what was there to explain noise
/// goes.
void Course::accept(Refit better) {
  final_ = std::move(better);
  const NoiseModel shown = shownNoise(final_.model->linear(), diagnosis_.noise, options_.seed);
  if (isQuieter(shown, diagnosis_.noise)) takeNoise(shown);
}

/// Everything fitted again for another noise.
bool Course::takeNoise(const NoiseModel& shown) {
  BatchOptions base = base_;
  shown.applyTo(base.problem);
  Refit nominal = refit(data_, nominal_.estimate, base, {}, shown);
  Refit present = refit(data_, final_.estimate, base, final_.effects, shown);
  if (!nominal.succeeded || !present.succeeded) return false;
  // Where readings contradict each other there are many minima: no effect is to profit from a better one.
  Refit back = refit(data_, present.estimate, base, {}, shown);
  if (back.succeeded && back.cost < nominal.cost) nominal = std::move(back);
  diagnosis_.noise = shown;
  base_ = base;
  nominal_ = std::move(nominal);
  fitted_.clear();
  final_ = onlyNeeded(std::move(present));
  if (!isLarge(final_, nominal_)) final_ = nominal_;
  locate();
  return true;
}

/// Of a camera by itself: noise is what is left by the contender that leaves least. Else all that leave less
/// than the nominal model's misfit look alike.
bool Course::takeLeastNoise() {
  if (!isCameraAlone()) return false;
  NoiseModel least = diagnosis_.noise;
  for (const auto& [names, fit] : fitted_) {
    if (!fit.succeeded) continue;
    const NoiseModel shown = shownNoise(fit.model->linear(), diagnosis_.noise, options_.seed);
    if (cameraNoise(shown) < cameraNoise(least)) least = shown;
  }
  return cameraNoise(least) < kLessNoise * cameraNoise(diagnosis_.noise) && takeNoise(least);
}

HeldOutResult Course::heldOut(const Refit& fit, bool yardsticks) const {
  HeldOutOptions options = options_.heldout;
  options.yardsticks = yardsticks;
  options.seed = options_.seed;
  return holdOut(linearize(data_, *problemAt(data_, fit.estimate, fit.options)), fit.effects,
                 fit.estimate.state, diagnosis_.noise, data_, options);
}

void Course::report() {
  diagnosis_.before = described(data_, nominal_.estimate, nominal_.options);
  diagnosis_.before_options = nominal_.options;
  diagnosis_.after = described(data_, final_.estimate, final_.options);
  diagnosis_.after_options = final_.options;
  diagnosis_.calibration = final_.estimate.state.effects;
}

/// Other effects in this one's place that are as good. One that is better takes its place, as the last of the
/// effects; then true, and nothing is added.
bool Course::addAlternatives(std::size_t effect) {
  const Refit rest = without(final_, effect);
  if (!rest.succeeded) return false;
  const Screening screening(*rest.model, options_.segments, lasting_only_);
  const auto& candidates = screening.candidates();
  const auto isOwn = [&](std::size_t m) {
    return candidates[m].candidate.effect == final_.effects[effect].effect;
  };
  std::optional<std::size_t> own;
  std::vector<std::size_t> order;
  for (std::size_t m = 0; m < candidates.size(); ++m) {
    if (isOwn(m) && (!own || candidates[m].support > candidates[*own].support)) own = m;
    if (!isOwn(m)) order.push_back(m);
  }
  if (!own) return false;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].support > candidates[b].support;
  });
  Alternatives set{{final_.effects[effect]}, {0}, {1}, {}};
  std::optional<SizedEffect> like;
  const double first_order = candidates[*own].support;
  double odds = 1;  // of it and all others in its place, against it
  std::size_t tried = 0;
  for (const std::size_t m : order) {
    if (candidates[m].support < leastOfContenders(first_order) || tried++ == kRivals) break;
    const bool listed =
        std::any_of(set.candidates.begin(), set.candidates.end(),
                    [&](const Candidate& other) { return other.effect == candidates[m].candidate.effect; });
    if (listed) continue;
    const Candidate other = candidates[m].candidate.isForGood()
                                ? candidates[m].candidate
                                : refinedInterval(*rest.model, candidates[m].candidate, segment_s());
    std::vector<Candidate> effects = rest.effects;
    effects.push_back(other);
    const Refit rival = fit(rest, effects);
    if (!rival.succeeded || !isBeyondBias(rival, rest, other)) continue;
    const double difference = worth(rival) - worth(final_);
    if (difference > 0) {
      final_ = rival;
      return true;
    }
    odds += std::exp(difference);
    if (difference < -kSameSupport) continue;
    set.candidates.push_back(other);
    set.support.push_back(difference);
    set.alignment.push_back(screening.alignment(*own, m));
    if (set.candidates.size() == 2) like = sized(rival, other);
  }
  confidence_[effect] = (1 - diagnosis_.alarm_p) / odds;
  if (!like) return false;
  try {
    set.advice = adviseManoeuvre(data_, *rest.model, final_.estimate.state,
                                 sized(final_, final_.effects[effect]), *like, diagnosis_.noise);
  } catch (const std::runtime_error&) {
    // A manoeuvre in which nothing holds the path tells nothing apart.
  }
  diagnosis_.alternatives.push_back(std::move(set));
  return false;
}

FoundEffect Course::describe(std::size_t effect) {
  FoundEffect found;
  found.candidate = final_.effects[effect];
  std::size_t scalars = 0;
  for (const EffectEstimate& estimate : final_.estimates)
    scalars += estimate.effect == found.candidate.effect;
  for (const EffectEstimate& estimate : withSpreads(final_))
    if (estimate.effect == found.candidate.effect) found.estimates.push_back(estimate);
  if (found.candidate.peak)
    found.candidate.peak = peakOf(final_.estimate.state.effects, found.candidate.effect);
  found.sqrt_lambda = sqrtLambda(final_, found.candidate.effect);
  found.confidence = confidence_[effect];
  const Refit rest = without(final_, effect);
  if (rest.succeeded) {
    found.support = supportOver(final_, rest);
    found.log_likelihood_gain = rest.cost - final_.cost;
    std::size_t rows = 0;
    for (const RowInfo& row : final_.model->linear().rows) rows += row.channel != BatchChannel::prior;
    found.bic_gain =
        2 * found.log_likelihood_gain - static_cast<double>(scalars) * std::log(static_cast<double>(rows));
  }
  found.interactions = interactionTests(final_, found.candidate);
  return found;
}

void Course::verify() {
  diagnosis_.remaining =
      final_.effects.empty() ? diagnosis_.mismatch : mismatchMaps(*final_.model, options_.seed);
  if (final_.effects.empty()) return;
  for (std::size_t i = 0; i < final_.effects.size(); ++i) diagnosis_.effects.push_back(describe(i));
  diagnosis_.heldout = heldOut(final_, true);
  for (std::size_t i = 0; i < diagnosis_.effects.size(); ++i)
    diagnosis_.effects[i].heldout_log_likelihood_gain = diagnosis_.heldout.gain.by_effect[i];
}

}  // namespace

Diagnosis diagnose(const BatchInput& input, const DiagnosisOptions& options) {
  return Course(input, options).run();
}

}  // namespace fathom
