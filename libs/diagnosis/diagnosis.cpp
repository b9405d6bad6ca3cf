#include "diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/progress.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "diagnosis/alternatives.h"
#include "diagnosis/discovery.h"
#include "diagnosis/fits.h"
#include "diagnosis/nominal.h"
#include "diagnosis/verdict.h"
#include "imaging/exposure_time.h"

namespace fathom {
namespace {

constexpr double kFarFromLinear = 100;  // support from which on an effect may be
constexpr double kFarShare = 0.3;       // of the largest support: what may be right then
constexpr std::size_t kLooked = 40, kContenders = 5;
constexpr double kLessNoise = 0.9;  // times the noise taken before: less than chance
// Of the likelihood that an effect gains, on stretches that it was not fitted to. Where these could not show
// a tenth of it, since poses follow it there, it has to gain that much where it was fitted, and over more
// than a few images: that share of the recording.
constexpr double kConfirmed = 0.3, kShownAtAll = 0.1, kUnseen = 50, kUnseenShare = 0.25;

/// To compare what a camera by itself shows: its noise and the markers' scatter, multiplied.
double cameraNoise(const NoiseModel& noise) {
  double product = noise.markers.largest_m() > 0 ? noise.markers.rms_m() : 1;
  for (const Channel channel : {kChannel<Markers>, kChannel<EpipolarResidual>, kChannel<Pixels>})
    product *= noise.of(channel).independentScale();
  return product;
}

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
         shown.print.parts < kLessNoise * before.print.parts ||
         shown.print.edges_px2 < kLessNoise * before.print.edges_px2;
}

/// The course of a diagnosis.
class Course {
 public:
  Course(const BatchInput& input, const DiagnosisOptions& options)
      : data_(input.data), start_(input.start), options_(options), fits_(input.data, options.segments) {}

  Diagnosis run() {
    if (!estimateNominal()) return std::move(diagnosis_);
    locate();
    attribute();
    verify();
    report();
    judge(diagnosis_, fits_.nominal().model->linear(), options_.calibration);
    return std::move(diagnosis_);
  }

 private:
  bool estimateNominal();
  void locate();
  void attribute();
  void verify();
  void report();

  bool insufficient(const std::string& why);
  std::optional<Refit> bestOf(const Refit& from, const Screening& screening, std::size_t size);
  std::vector<Candidate> farContenders(const Screening& screening) const;
  bool isBelieved(const Refit& fit, const Looks& looks);
  bool leaveOutUnconfirmed(const Refit& fit);
  void accept(Refit better);
  bool lastsLong(const Candidate& effect) const;
  bool takeNoise(const NoiseModel& shown);
  bool takeLeastNoise();
  /// Its fits are quick.
  bool isCameraAlone() const { return !data_.hasMotion(); }
  HeldOutResult heldOut(const Refit& fit, bool yardsticks) const;
  void lookForAlternatives();
  EffectEstimate whole(EffectEstimate estimate) const;
  FoundEffect describe(std::size_t effect);

  const BatchData& data_;
  const StartPath& start_;
  DiagnosisOptions options_;
  Fits fits_;
  Refit final_;
  std::set<std::size_t>
      lasting_only_;                // effects of which a part of the recording was tried, and not confirmed
  std::vector<double> confidence_;  // of each effect in the final model
  Diagnosis diagnosis_;
};

bool Course::insufficient(const std::string& why) {
  diagnosis_.verdict = Verdict::insufficient;
  diagnosis_.why = why;
  return false;
}

bool Course::estimateNominal() {
  NominalFit nominal = nominalFit(
      data_, start_, beyondStated(options_.calibration, statedExposure_s(data_.vehicle)), options_.seed);
  diagnosis_.noise = nominal.noise;
  if (!nominal.failure.empty()) return insufficient(nominal.failure);
  final_ = nominal.fit;
  fits_.beginWith(std::move(nominal.fit), std::move(nominal.options), nominal.noise);
  return true;
}

void Course::locate() { diagnosis_.mismatch = mismatchMaps(*fits_.nominal().model, options_.seed); }

/// The best set of so many more effects, each contender estimated in full.
std::optional<Refit> Course::bestOf(const Refit& from, const Screening& screening, std::size_t size) {
  const std::vector<TestedSet> sets = screening.bestSets(size, kLooked, Fits::kLogOdds);
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
  std::vector<Refit> all = fits_.of(from, contenders);
  double highest = -1e300;
  for (const Refit& refitted : all) highest = std::max(highest, fits_.worth(refitted));
  for (Refit& refitted : all) {
    if (!refitted.succeeded || fits_.worth(refitted) < leastOfContenders(highest)) continue;
    Refit own = fits_.settled(std::move(refitted));
    if (!best || fits_.worth(own) > fits_.worth(*best)) best = std::move(own);
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
  for (const auto& [effect, tested] : nearest) {
    contenders.push_back(tested->candidate);
    if (tested->candidate.active_s == Interval{}) continue;
    // What lasts may do too much to first order where it is largest: then a part of it seems to fit better.
    contenders.push_back(tested->candidate);
    contenders.back().active_s = {};
  }
  return contenders;
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
      for (TestedCandidate& tested : diagnosis_.tested)
        for (EffectEstimate& one : tested.one_step) one = whole(one);
      stableSort(diagnosis_.tested,
                 [](const TestedCandidate& a, const TestedCandidate& b) { return a.support > b.support; });
    }
    if (alarm > options_.false_alarm) break;
    const std::size_t left = options_.max_effects - final_.effects.size();
    std::optional<Refit> best = bestOf(final_, screening, left);
    if (!best) break;
    if (takeLeastNoise()) continue;
    Refit better = fits_.lastingWhereBetter(fits_.onlyNeeded(std::move(*best)));
    if (!final_.effects.empty() && fits_.worth(better) <= fits_.worth(final_)) break;
    if (!isBelieved(better, looks)) break;
    if (leaveOutUnconfirmed(better)) continue;
    accept(std::move(better));
  }
  lookForAlternatives();
}

/// Other effects in each one's place that are as good; one that is better takes it.
void Course::lookForAlternatives() {
  confidence_.assign(final_.effects.size(), 1 - diagnosis_.alarm_p);
  for (std::size_t i = 0; i < final_.effects.size();) {
    InItsPlace others = othersInPlaceOf(i, final_, fits_, lasting_only_);
    if (others.better) {
      final_ = std::move(*others.better);
      continue;
    }
    confidence_[i] /= others.odds;
    if (others.set) diagnosis_.alternatives.push_back(std::move(*others.set));
    ++i;
  }
}

/// What has raised the alarm may be another than what is best supported, or explain less once refitted.
bool Course::isBelieved(const Refit& fit, const Looks& looks) {
  const double alarm = alarmOf(-supportOver(fit, final_), isLasting(fit), looks);
  const Candidate& first = fit.effects.front();
  const bool alone = fit.effects.size() == 1;
  const bool is_large =
      isLarge(fit, final_) && (!alone || sqrtLambda(fit, first.effect) >= discoveryOf(first));
  if (is_large && alarm <= options_.false_alarm) {
    if (!alone || isBeyondBias(fit, fits_.nominal(), first)) return true;
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
  if (effect.peak) return false;
  const double least_s = kUnseenShare * (data_.last_s - data_.first_s);
  if (effect.time_s)
    return *effect.time_s - data_.first_s > least_s && data_.last_s - *effect.time_s > least_s;
  const double on_s =
      std::min(effect.active_s.to_s, data_.last_s) - std::max(effect.active_s.from_s, data_.first_s);
  return on_s > least_s;
}

/// An effect for a part of the recording can be made to fit any few images that are a little off: it must
/// show on stretches that it was not fitted to. One that does not is not tried again.
bool Course::leaveOutUnconfirmed(const Refit& fit) {
  const auto isPart = [](const Candidate& effect) { return !effect.isForGood(); };
  if (std::none_of(fit.effects.begin(), fit.effects.end(), isPart)) return false;
  const HeldOutResult held = heldOut(fit, false);
  bool any = false;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const Refit rest = fits_.without(fit, i);
    const double gain = rest.succeeded ? rest.cost - fit.cost : 0;
    const double expected = std::min(gain, held.gain.expected_by_effect[i]);
    const bool shown = expected >= kShownAtAll * gain ? held.gain.by_effect[i] > kConfirmed * expected
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
  const NoiseModel shown = shownNoise(final_.model->linear(), fits_.noise(), options_.seed);
  if (isQuieter(shown, fits_.noise())) takeNoise(shown);
}

/// Everything fitted again for another noise.
bool Course::takeNoise(const NoiseModel& shown) {
  BatchOptions base = fits_.base();
  shown.applyTo(base.problem);
  Refit nominal = refit(data_, fits_.nominal().estimate, base, {}, shown);
  Refit present = refit(data_, final_.estimate, base, final_.effects, shown);
  if (!nominal.succeeded || !present.succeeded) return false;
  // Where readings contradict each other there are many minima: no effect is to profit from a better one.
  Refit back = refit(data_, present.estimate, base, {}, shown);
  if (back.succeeded && back.cost < nominal.cost) nominal = std::move(back);
  fits_.beginWith(std::move(nominal), std::move(base), shown);
  final_ = fits_.onlyNeeded(std::move(present));
  if (!isLarge(final_, fits_.nominal())) final_ = fits_.nominal();
  locate();
  return true;
}

/// Of a camera by itself: noise is what is left by the contender that leaves least. Else all that leave less
/// than the nominal model's misfit look alike.
bool Course::takeLeastNoise() {
  if (!isCameraAlone()) return false;
  NoiseModel least = fits_.noise();
  fits_.forEach([&](const Refit& fit) {
    if (!fit.succeeded) return;
    const NoiseModel shown = shownNoise(fit.model->linear(), fits_.noise(), options_.seed);
    if (cameraNoise(shown) < cameraNoise(least)) least = shown;
  });
  return cameraNoise(least) < kLessNoise * cameraNoise(fits_.noise()) && takeNoise(least);
}

HeldOutResult Course::heldOut(const Refit& fit, bool yardsticks) const {
  HeldOutOptions options = options_.heldout;
  options.yardsticks = yardsticks;
  options.seed = options_.seed;
  return holdOut(linearize(data_, *problemAt(data_, fit.estimate, fit.options)), fit.effects,
                 fit.estimate.state, fits_.noise(), data_, options);
}

void Course::report() {
  diagnosis_.noise = fits_.noise();
  diagnosis_.before = described(data_, fits_.nominal().estimate, fits_.nominal().options);
  diagnosis_.before_options = fits_.nominal().options;
  diagnosis_.after = described(data_, final_.estimate, final_.options);
  diagnosis_.after_options = final_.options;
  diagnosis_.calibration = wholeOf(final_.estimate.state.effects, statedExposure_s(data_.vehicle));
}

/// As reports have it.
EffectEstimate Course::whole(EffectEstimate estimate) const {
  estimate.value = wholeOf(estimate.scalar, estimate.value, statedExposure_s(data_.vehicle));
  return estimate;
}

FoundEffect Course::describe(std::size_t effect) {
  FoundEffect found;
  found.candidate = final_.effects[effect];
  std::size_t scalars = 0;
  for (const EffectEstimate& estimate : final_.estimates)
    scalars += estimate.effect == found.candidate.effect;
  for (const EffectEstimate& estimate : withSpreads(final_))
    if (estimate.effect == found.candidate.effect) found.estimates.push_back(whole(estimate));
  if (found.candidate.peak)
    found.candidate.peak = peakOf(final_.estimate.state.effects, found.candidate.effect);
  found.sqrt_lambda = sqrtLambda(final_, found.candidate.effect);
  found.confidence = confidence_[effect];
  const Refit rest = fits_.without(final_, effect);
  if (rest.succeeded) {
    found.support = supportOver(final_, rest);
    found.log_likelihood_gain = rest.cost - final_.cost;
    std::size_t rows = 0;
    for (const RowInfo& row : final_.model->linear().rows) rows += row.channel != kChannel<Prior>;
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
