#include "diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "core/progress.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "diagnosis/alternatives.h"
#include "diagnosis/confirmation.h"
#include "diagnosis/constants.h"
#include "diagnosis/contenders.h"
#include "diagnosis/fits.h"
#include "diagnosis/nominal.h"
#include "diagnosis/onset.h"
#include "diagnosis/shown_noise.h"
#include "diagnosis/verdict.h"
#include "imaging/exposure_time.h"

namespace fathom {
namespace {

std::vector<TestedCandidate> likeliestFirst(std::vector<TestedCandidate> tested) {
  stableSort(tested, [](const TestedCandidate& a, const TestedCandidate& b) {
    return a.log_evidence > b.log_evidence;
  });
  return tested;
}

double mostLikely(const Screening& screening) {
  double most = -std::numeric_limits<double>::infinity();
  for (const TestedCandidate& tested : screening.candidates()) most = std::max(most, tested.log_evidence);
  return most;
}

/// The course of a diagnosis.
class Course {
 public:
  Course(const BatchInput& input, const DiagnosisOptions& options)
      : data_(input.data), start_(input.start), options_(options), fits_(input.data, options.segments) {
    // What a camera by itself leaves of noise is told by what explains most of it, for however short a time.
    if (!isCameraAlone()) left_out_.shorter_s = heldOutStretch_s(data_, options.heldout);
  }

  Diagnosis run() {
    try {
      if (!estimateNominal()) return std::move(diagnosis_);
      locate();
      attribute();
      verify();
      report();
      judge(diagnosis_, fits_.nominal().model->linear());
    } catch (const Singular&) {
      // As of a sensor that always says the same: it weighs 1e10 times as much as others.
      insufficient("readings weigh so much beside others that rounding hides what these tell");
      diagnosis_.effects.clear();
    }
    return std::move(diagnosis_);
  }

 private:
  bool estimateNominal();
  void locate();
  void attribute();
  void verify();
  bool isBeyondChance() const;
  void withdraw();
  void report();

  bool insufficient(const std::string& why);
  std::vector<Refit> contenders(const Screening& screening, std::size_t size);
  void noteScreening(const Screening& screening);
  void accept(Refit better);
  bool addsTo(const Refit& present, const Refit& better) const;
  bool takeMinimumOf(const std::vector<Refit>& found);
  bool takeNoise(const NoiseModel& shown);
  bool takeLeastNoise();
  /// Its fits are quick.
  bool isCameraAlone() const { return !data_.hasMotion(); }
  HeldOutOptions heldOutOptions(bool yardsticks) const;
  void lookForAlternatives();
  void lookUnderTightBudget();
  EffectEstimate whole(EffectEstimate estimate) const;
  FoundEffect describe(std::size_t effect);

  const BatchData& data_;
  const StartPath& start_;
  DiagnosisOptions options_;
  Fits fits_;
  Refit final_;
  LeftOut left_out_;
  std::vector<double> rivals_odds_;  // of each effect in the final model: its own and its rivals', against it
  Diagnosis diagnosis_;
};

bool Course::insufficient(const std::string& why) {
  diagnosis_.verdict = Verdict::insufficient;
  diagnosis_.why = why;
  return false;
}

bool Course::estimateNominal() {
  NominalFit nominal =
      nominalFit(data_, start_, beyondStated(options_.calibration, statedExposure_s(data_.vehicle)),
                 options_.budget, options_.seed);
  diagnosis_.noise = nominal.noise;
  if (!nominal.failure.empty()) return insufficient(nominal.failure);
  final_ = nominal.fit;
  fits_.beginWith(std::move(nominal.fit), std::move(nominal.options), nominal.noise);
  return true;
}

void Course::locate() { diagnosis_.mismatch = mismatchMaps(*fits_.nominal().model, options_.seed); }

/// Sets of up to so many more effects that may be the best, each estimated in full: larger ones where smaller
/// ones are not nearly what those are foretold to be, since what else is missing is looked for again.
std::vector<Refit> Course::contenders(const Screening& screening, std::size_t size) {
  const std::vector<Contender> contenders = contendersOf(screening, size, fits_.threshold(), isCameraAlone());
  std::vector<Refit> all;
  double highest = -1e300;
  for (std::size_t count = 1; count <= size; ++count) {
    std::vector<std::vector<Candidate>> sets;
    for (const auto& [more, foretold] : contenders) {
      // What least noise is left by, see takeLeastNoise(), may be a larger one.
      const bool may_be_best =
          isCameraAlone() || fits_.logOdds(final_) + leastOfContenders(foretold) > highest;
      if (more.size() == count && may_be_best) {
        sets.push_back(final_.effects);
        sets.back().insert(sets.back().end(), more.begin(), more.end());
      }
    }
    for (Refit& refitted : fits_.of(final_, sets)) {
      highest = std::max(highest, fits_.logOdds(refitted));
      all.push_back(std::move(refitted));
    }
  }
  std::erase_if(all, [&](const Refit& refitted) {
    return !refitted.succeeded || fits_.logOdds(refitted) < leastOfContenders(highest);
  });
  return all;
}

bool Course::addsTo(const Refit& present, const Refit& better) const {
  return better.effects != present.effects &&
         fits_.logOdds(better) >=
             fits_.logOdds(present) + (present.effects.empty() ? fits_.threshold() : fits_.thresholdBeside());
}

void Course::attribute() {
  Progress progress("trying effects");
  bool is_new = true;
  while (final_.effects.size() < options_.max_effects) {
    progress.update(static_cast<double>(final_.effects.size()) / static_cast<double>(options_.max_effects));
    const Screening screening(*final_.model, options_.segments, left_out_);
    if (is_new) noteScreening(screening);
    is_new = false;
    if (!isCameraAlone() && mostLikely(screening) < fits_.threshold() - kUnderestimated) break;
    std::vector<Refit> tried =
        contenders(screening, std::min(kTogether, options_.max_effects - final_.effects.size()));
    if (takeMinimumOf(tried) || takeLeastNoise()) {
      is_new = final_.effects.empty();
      continue;
    }
    std::optional<Refit> best = fits_.bestOf(fits_.settled(std::move(tried)));
    if (!best || fits_.logOdds(*best) < fits_.logOdds(final_)) break;
    Refit better = fits_.lastingWhereBetter(fits_.onlyNeeded(std::move(*best)));
    if (!addsTo(final_, better)) break;
    const std::size_t left_out = left_out_.count();
    better = confirmed(std::move(better), final_.effects,
                       {fits_, heldOutOptions(false), left_out_, diagnosis_.remarks});
    if (addsTo(final_, better))
      accept(std::move(better));
    else if (left_out_.count() == left_out)
      break;
  }
  lookForAlternatives();
  lookUnderTightBudget();
}

/// What would be named were less allowed for: the most telling of what this budget, and nothing else, keeps
/// from being named.
void Course::lookUnderTightBudget() {
  if (options_.tight_budget.name == options_.budget.name) return;
  const ErrorBudget tight = options_.tight_budget.of(pipelineOf(data_.vehicle));
  const Screening screening(*final_.model, final_.noise.with(tight), options_.segments, left_out_);
  std::vector<TestedCandidate> telling = likeliestFirst(screening.candidates());
  std::erase_if(telling,
                [&](const TestedCandidate& tested) { return tested.log_evidence < fits_.threshold(); });
  if (telling.empty()) return;
  const WhitenedModel declared = final_.model->under(final_.noise.declared());
  const PriorOdds prior(declared.linear(), options_.segments);
  const auto most = std::find_if(telling.begin(), telling.end(), [&](const TestedCandidate& tested) {
    const double here = evidencesOf(declared, {tested.candidate}).front() + prior.logOf(tested.candidate);
    return here < fits_.threshold() && here < tested.log_evidence - kExcluded;
  });
  if (most == telling.end()) return;
  diagnosis_.allowed = {*most, options_.budget.name, tight.name};
  for (EffectEstimate& one : diagnosis_.allowed->most.one_step) one = whole(one);
}

/// What all was tried at the nominal model, and how likely the likeliest is by chance.
void Course::noteScreening(const Screening& screening) {
  const Screening::Chance chance = screening.chance(options_.seed);
  fits_.setThreshold(std::max(kEvenOdds, chance.evidenceOf(options_.false_alarm)));
  diagnosis_.tested = likeliestFirst(screening.candidates());
  for (TestedCandidate& tested : diagnosis_.tested)
    for (EffectEstimate& one : tested.one_step) one = whole(one);
  if (diagnosis_.tested.empty()) return;
  diagnosis_.most_improbable = nameOf(diagnosis_.tested.front().candidate);
  diagnosis_.alarm_p = chance.alarmOf(diagnosis_.tested.front().log_evidence);
}

/// Other effects in each one's place that are as good; one that is better takes it.
void Course::lookForAlternatives() {
  rivals_odds_.assign(final_.effects.size(), 1);
  fits_.makeWithoutEach(final_);
  for (std::size_t i = 0; i < final_.effects.size();) {
    InItsPlace others = othersInPlaceOf(i, final_, fits_, left_out_);
    if (others.better) {
      final_ = std::move(*others.better);
      final_.model = modelOf(data_, final_);
      continue;
    }
    rivals_odds_[i] = others.odds;
    if (others.set) diagnosis_.alternatives.push_back(std::move(*others.set));
    ++i;
  }
}

/// What a large effect does beyond the first order was taken for noise as long as it was not in the model:
/// where noise now shows to be less, everything is fitted again with it, and what was there to explain noise
/// goes.
void Course::accept(Refit better) {
  final_ = std::move(better);
  final_.model = modelOf(data_, final_);
  const NoiseModel shown = shownNoise(final_.model->linear(), fits_.noise(), options_.seed);
  if (isQuieter(shown, fits_.noise())) takeNoise(shown);
}

/// Where readings contradict each other there are many minima, and no effect is to profit from a better one:
/// where one gains more than its size accounts for.
bool Course::takeMinimumOf(const std::vector<Refit>& found) {
  const auto likeliest = std::max_element(found.begin(), found.end(), [](const Refit& a, const Refit& b) {
    return a.weight.log_evidence < b.weight.log_evidence;
  });
  if (likeliest == found.end() || likeliest->weight.log_evidence < fits_.nominal().weight.log_evidence +
                                                                       likeliest->weight.log_bayes_factor +
                                                                       kOtherMinimum)
    return false;
  const auto isBetter = [](const Refit& there, const Refit& here) {
    return there.succeeded && there.weight.log_evidence > here.weight.log_evidence + kOtherMinimum;
  };
  const auto withOnly = [&](const std::vector<Candidate>& effects) {
    return refit(data_, *likeliest, fits_.base(), effects, fits_.noise());
  };
  Refit nominal = withOnly({});
  Refit present = final_.effects.empty() ? nominal : withOnly(final_.effects);
  if (!isBetter(nominal, fits_.nominal()) && !isBetter(present, final_)) return false;
  if (!isBetter(nominal, fits_.nominal())) nominal = fits_.nominal();
  if (!isBetter(present, final_)) present = final_;
  fits_.beginWith(std::move(nominal), BatchOptions(fits_.base()), NoiseModel(fits_.noise()));
  final_ = std::move(present);
  locate();
  return true;
}

/// Everything fitted again for another noise.
bool Course::takeNoise(const NoiseModel& shown) {
  BatchOptions base = fits_.base();
  shown.applyTo(base.problem);
  Refit nominal, present;
  bothAtOnce([&] { nominal = refit(data_, fits_.nominal(), base, {}, shown); },
             [&] { present = refit(data_, final_, base, final_.effects, shown); });
  if (!nominal.succeeded || !present.succeeded) return false;
  // Where readings contradict each other there are many minima: no effect is to profit from a better one.
  const BatchEstimate back = minimumFrom(data_, present.estimate, nominal.options);
  if (back.succeeded && back.cost < nominal.estimate.cost - kCostTolerance)
    nominal = refit(data_, startingAt(back), base, {}, shown);
  if (!nominal.succeeded) return false;
  fits_.beginWith(std::move(nominal), std::move(base), shown);
  final_ = fits_.onlyNeeded(std::move(present));
  if (fits_.logOdds(final_) < fits_.threshold()) final_ = fits_.nominal();
  final_.model = modelOf(data_, final_);
  locate();
  return true;
}

/// Of a camera by itself: noise is what is left by the contender that leaves least. Else all that leave less
/// than the nominal model's misfit look alike.
bool Course::takeLeastNoise() {
  if (!isCameraAlone()) return false;
  NoiseModel least = fits_.noise();
  fits_.forEach([&](const Refit& fit) {
    const NoiseModel shown = shownNoise(modelOf(data_, fit)->linear(), fits_.noise(), options_.seed);
    if (cameraNoise(shown) < cameraNoise(least)) least = shown;
  });
  return cameraNoise(least) < kLessNoise * cameraNoise(fits_.noise()) && takeNoise(least);
}

HeldOutOptions Course::heldOutOptions(bool yardsticks) const {
  HeldOutOptions options = options_.heldout;
  options.yardsticks = yardsticks;
  options.seed = options_.seed;
  return options;
}

void Course::report() {
  diagnosis_.noise = final_.noise;
  diagnosis_.log_odds = fits_.logOdds(final_);
  diagnosis_.log_likelihood_gain = fits_.gainOf(final_);
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
  for (const EffectEstimate& estimate : withSpreads(final_))
    if (estimate.effect == found.candidate.effect) found.estimates.push_back(whole(estimate));
  if (found.candidate.peak)
    found.candidate.peak = peakOf(final_.estimate.state.effects, found.candidate.effect);
  found.sqrt_lambda = sqrtLambda(final_, found.candidate.effect);
  const Refit rest = fits_.without(final_, effect);
  found.log_odds = fits_.logOdds(final_);
  if (rest.succeeded) {
    found.log_odds -= fits_.logOdds(rest);
    found.log_likelihood_gain = fits_.gainOf(final_) - fits_.gainOf(rest);
    found.bic_gain = 2 * found.log_likelihood_gain;
  }
  found.confidence = 1 / (rivals_odds_[effect] + oddsAgainst(found.log_odds) +
                          (final_.effects.size() > 1 ? oddsAgainst(fits_.logOdds(final_)) : 0));
  found.interactions = interactionTests(final_, found.candidate);
  for (const Alternatives& set : diagnosis_.alternatives)
    if (set.candidates[0] == final_.effects[effect] && hasFailed(found.interactions) &&
        isAnotherSameEverywhere(set, effect, final_, fits_))
      for (InteractionTest& test : found.interactions) test.failed = false;
  return found;
}

void Course::verify() {
  diagnosis_.remaining =
      final_.effects.empty() ? diagnosis_.mismatch : mismatchMaps(*final_.model, options_.seed);
  if (final_.effects.empty()) return;
  for (std::size_t i = 0; i < final_.effects.size(); ++i) diagnosis_.effects.push_back(describe(i));
  diagnosis_.heldout = heldOut(fits_, final_, heldOutOptions(true));
  if (!isBeyondChance()) return withdraw();
  for (std::size_t i = 0; i < diagnosis_.effects.size(); ++i)
    diagnosis_.effects[i].heldout_log_likelihood_gain = diagnosis_.heldout.gain.by_effect[i];
}

/// Chance, too, finds something that fits. What all stretches tell alike, as an offset that is held by a
/// prior, none of them adds much to: where they gain what they should, and that is no more than chance may,
/// all readings have to gain the more. What is known gains E there with a variance of 2 E.
bool Course::isBeyondChance() const {
  const HeldOutGain& gain = diagnosis_.heldout.gain;
  const double expected =
      std::accumulate(gain.expected_by_effect.begin(), gain.expected_by_effect.end(), 0.0);
  const bool is_as_expected = gain.physics > expected - kFivePercent * std::sqrt(2 * expected);
  return gain.physics > gain.placebo ||
         ((is_as_expected || expected <= gain.placebo) && fits_.gainOf(final_) > kUnseen);
}

void Course::withdraw() {
  for (const FoundEffect& found : diagnosis_.effects)
    diagnosis_.remarks.push_back(
        nameOf(found.candidate) +
        print(" would fit, but gains no more, on stretches that it was not fitted to, than the best of all "
              "effects does by chance (%.1f where chance has %.1f, in ln of the likelihood; %.1f on all)",
              diagnosis_.heldout.gain.physics, diagnosis_.heldout.gain.placebo, fits_.gainOf(final_)));
  diagnosis_.effects.clear();
  diagnosis_.alternatives.clear();
  diagnosis_.heldout = {};
  final_ = fits_.nominal();
  diagnosis_.remaining = diagnosis_.mismatch;
}

}  // namespace

Diagnosis diagnose(const BatchInput& input, const DiagnosisOptions& options) {
  return Course(input, options).run();
}

}  // namespace fathom
