#include "diagnosis/verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/stable_sort.h"
#include "core/text.h"
#include "diagnosis/black_box.h"
#include "diagnosis/budget_entries.h"
#include "diagnosis/constants.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

/// "scale = 0.01 ± 0.0004, …".
std::string textOf(const std::vector<EffectEstimate>& estimates, const EffectInfo& effect) {
  std::string text;
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& p : effect.parameters) {
    for (int i = 0; i < p.size; ++i, ++scalar)
      for (const EffectEstimate& estimate : estimates)
        if (estimate.scalar == scalar && estimate.image < 0) {
          const std::string axis = p.size > 1 ? print("[%d]", i) : "";
          text += print("%s%s%s = %.4g ± %.2g", text.empty() ? "" : ", ", std::string(p.name).c_str(),
                        axis.c_str(), asNamed(p, estimate.value),
                        sigmaAsNamed(p, estimate.value, estimate.sigma));
        }
  }
  return text;
}

/// "dvl-scale (DVL scale): scale = 0.01 ± 0.0004; its size is …".
std::string sentence(const FoundEffect& found) {
  const EffectInfo& effect = allEffects()[found.candidate.effect];
  return nameOf(found.candidate) + " (" + std::string(effect.text.title) +
         "): " + textOf(found.estimates, effect) +
         print("; its size is %.1f times what the recording can resolve", found.sqrt_lambda);
}

void remarkOnAllowance(Diagnosis& diagnosis) {
  if (!diagnosis.allowed) return;
  const auto& [most, budget, tight] = *diagnosis.allowed;
  std::vector<EffectEstimate> known = most.one_step;  // better than before
  std::erase_if(known, [](const EffectEstimate& one) {
    const double prior_sigma = parameterOf(one.scalar).prior_sigma;
    return one.sigma > prior_sigma || one.sigma < kNothingTold * prior_sigma;
  });
  const std::string sizes = textOf(known, allEffects()[most.candidate.effect]);
  diagnosis.remarks.push_back(nameOf(most.candidate) + (sizes.empty() ? "" : " (" + sizes + ")") +
                              " is within what the budget `" + budget + "` allows for; under `" + tight +
                              "` it would be looked into");
}

void remarkOnNoise(Diagnosis& diagnosis) {
  for (const Channel channel : kEveryChannel)
    if (const ChannelNoise& noise = diagnosis.noise.of(channel);
        noise.rows > 0 && channel != kChannel<Prior> && (noise.scale > kNoisier || noise.scale < kQuieter))
      diagnosis.remarks.push_back(
          print("%s: %.2f times the noise stated", nameOf(channel).c_str(), noise.scale));
}

bool isLeft(const Mismatch& map) { return map.material && map.log_p < std::log(kUnexplained_p); }

/// Of log likelihood, what a correction by one covariate would still take away beyond chance.
double leftBy(const Mismatch& map) { return std::max(0.0, 0.5 * (map.statistic_value - map.dof)); }

std::string textOf(const Mismatch& map) {
  return print("%s of %s against %s (%s: %.1f sigma, %.2g %s in all)", map.statistic.c_str(),
               nameOf(map.channel).c_str(), map.against.c_str(), map.where.c_str(), map.size_sigma,
               map.size_raw, map.raw_unit.c_str());
}

std::string textOf(const FoundEffect& found, const InteractionTest& test) {
  return print("%s would have to change with %s, by %.0f %% over one standard deviation of it",
               nameOf(found.candidate).c_str(), test.against.c_str(), 100 * test.relative_change);
}

/// "marker-scale, 0.01 where 0.002 is ordinary, at marker 583 and 3 more".
std::string textOf(const BudgetEntry& entry) {
  std::string text = print("%s, %.2g%s where %.2g is ordinary", entry.component.c_str(),
                           entry.apart.empty() ? entry.estimate : entry.largest_apart,
                           (entry.unit == "1" ? "" : " " + entry.unit).c_str(), entry.prior);
  if (!entry.apart.empty()) text += ", at " + entry.apart[0];
  if (entry.apart.size() > 1) text += print(" and %zu more", entry.apart.size() - 1);
  if (entry.outlier_share > 0)
    text += print(
        "; %.2g %% of its readings are outliers, as where something is hidden or covered, the others "
        "%.2g",
        100 * entry.outlier_share, entry.others);
  return text;
}

/// A correction that would still take something away.
struct Left {
  double log_likelihood = 0;  ///< beyond chance
  double statistic = 0;       ///< chi-square of dof by chance
  int dof = 0;
  std::string where, unit;
  double size = 0;
  std::optional<Channel> channel{};  ///< whose readings it is in; nothing: of several
};

/// Of what was tried first where nothing is stated, because it did not stand when it was fitted in full or
/// held out: chance, to which the budget belongs, does not give it.
Left improbable(const Diagnosis& diagnosis) {
  const double log_likelihood = -std::log(std::max(diagnosis.alarm_p, std::numeric_limits<double>::min()));
  return {
      log_likelihood,
      1 + 2 * log_likelihood,
      1,
      print("a misfit that %s comes nearest to, though it does not hold when it is fitted (by chance with "
            "probability %.2g)",
            diagnosis.most_improbable.c_str(), diagnosis.alarm_p),
      "sigma",
      std::sqrt(2 * log_likelihood)};
}

/// What matters of it, the largest first: beside the effects, or beyond the budget.
std::vector<Left> leftBeside(const Diagnosis& diagnosis) {
  std::vector<Left> all;
  for (const Mismatch& map : diagnosis.remaining)
    if (isLeft(map))
      all.push_back(
          {leftBy(map), map.statistic_value, map.dof, textOf(map), map.raw_unit, map.size_raw, map.channel});
  for (const FoundEffect& found : diagnosis.effects)
    for (const InteractionTest& test : found.interactions)
      if (test.failed)
        all.push_back({0.5 * (test.statistic - 1), test.statistic, 1, textOf(found, test), "%",
                       100 * std::abs(test.relative_change)});
  for (const BudgetEntry& entry : diagnosis.budget)
    if (entry.bursts)
      all.push_back({entry.beyond, 1 + 2 * entry.beyond, 1, textOf(entry), entry.unit,
                     entry.apart.empty() ? entry.estimate : entry.largest_apart});
  if (diagnosis.effects.empty() && diagnosis.alarm_p < kNoChance_p) all.push_back(improbable(diagnosis));
  stableSort(all, [](const Left& a, const Left& b) { return a.log_likelihood > b.log_likelihood; });
  return all;
}

/// By log likelihood, of what the effects take away and what is left besides.
void shareOut(Diagnosis& diagnosis) {
  double taken = 0, by_effects = 0;
  for (const FoundEffect& found : diagnosis.effects)
    by_effects += std::max(0.0, found.heldout_log_likelihood_gain);
  // Held-out stretches, each given all the others, may gain more in sum than all of it at once.
  taken = std::max(std::min(diagnosis.heldout.gain.physics, diagnosis.log_likelihood_gain), 0.0);
  const std::vector<Left> beside = leftBeside(diagnosis);
  const double left = beside.empty() ? 0 : beside.front().log_likelihood;
  if (left > 0)
    diagnosis.remainder = {left / (taken + left), beside.front().where, beside.front().unit,
                           beside.front().size, true};
  for (FoundEffect& found : diagnosis.effects)
    found.share = by_effects > 0
                      ? taken / (taken + left) * std::max(0.0, found.heldout_log_likelihood_gain) / by_effects
                      : 0;
}

std::vector<std::string> failuresOf(const Diagnosis& diagnosis) {
  std::vector<std::string> failures;
  if (diagnosis.remainder.share > 1 - kExplained)
    for (const Left& left : leftBeside(diagnosis)) failures.push_back(left.where);
  return failures;
}

std::string effectsText(const Diagnosis& diagnosis) {
  std::string text;
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i)
    text += (i > 0 ? "; and " : "") + sentence(diagnosis.effects[i]);
  return text;
}

void tellUnexplained(Diagnosis& diagnosis, const std::vector<std::string>& failures) {
  const bool is_likely = std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                                     [](const FoundEffect& found) { return found.confidence >= 0.5; });
  if (diagnosis.effects.empty())
    diagnosis.why = "Something is missing that no effect of the catalogue describes. It shows as ";
  else if (is_likely)
    diagnosis.why = "The model leaves out " + effectsText(diagnosis) + ". That is not all: it shows as ";
  else
    diagnosis.why =
        "Something else is missing than what comes nearest, " + effectsText(diagnosis) + ". It shows as ";
  diagnosis.why += failures[0];
  for (std::size_t i = 1; i < std::min(kToldFailures, failures.size()); ++i)
    diagnosis.why += "; " + failures[i];
  diagnosis.why += ".";
}

/// Of physics that is not what one would estimate anew in any case.
void remarkOnYardstick(Diagnosis& diagnosis) {
  const bool is_physics =
      std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                  [](const FoundEffect& found) { return !BlackBox::isRemedy(found.candidate.effect); });
  if (is_physics && diagnosis.heldout.gain.over_black_box_ci95[0] <= 0)
    diagnosis.remarks.emplace_back(
        "a correction without physics (splines, camera or mounting calibrated anew) fits stretches that it "
        "was not fitted to as well");
}

void judgeExplained(Diagnosis& diagnosis) {
  diagnosis.verdict = Verdict::explained;
  diagnosis.why = "The model leaves out " + effectsText(diagnosis) + ".";
  if (diagnosis.remainder.share > 0)
    diagnosis.remarks.push_back(print("%.2g %% of the mismatch remains: ", 100 * diagnosis.remainder.share) +
                                diagnosis.remainder.where);
}

void tellAlternatives(Diagnosis& diagnosis) {
  for (const Alternatives& set : diagnosis.alternatives) {
    diagnosis.why += " As good in place of " + nameOf(set.candidates[0]) + ":";
    for (std::size_t i = 1; i < set.candidates.size(); ++i)
      diagnosis.why += (i > 1 ? ", " : " ") + nameOf(set.candidates[i]);
    diagnosis.why += ". This recording cannot choose among them.";
    if (!set.advice.manoeuvre.empty()) diagnosis.why += " To tell them apart: " + textOf(set.advice) + ".";
  }
}

/// What is left by an unknown correction, were its size just what the readings show (empirical Bayes), of as
/// many maps as were looked at.
double oddsOfSomethingElse(const Diagnosis& diagnosis) {
  const std::vector<Left> beside = leftBeside(diagnosis);
  if (beside.empty() || beside.front().statistic <= beside.front().dof) return 0;
  const Left& most = beside.front();
  const double log_odds = 0.5 * (most.statistic - most.dof - most.dof * std::log(most.statistic / most.dof)) -
                          std::log(std::max(1.0, static_cast<double>(diagnosis.remaining.size())));
  return std::exp(std::min(log_odds, kMostLogOdds));
}

/// The effects stated, all but one of them, each rival in one's place, what is none of the catalogue, and
/// nothing at all; where nothing is stated, what would have been, to first order.
void weighHypotheses(Diagnosis& diagnosis) {
  std::vector<Candidate> stated;
  for (const FoundEffect& found : diagnosis.effects) stated.push_back(found.candidate);
  diagnosis.posterior.push_back({stated, false, 1});
  for (const Alternatives& set : diagnosis.alternatives)
    for (std::size_t k = 1; k < set.candidates.size(); ++k) {
      std::vector<Candidate> other = stated;
      std::replace(other.begin(), other.end(), set.candidates[0], set.candidates[k]);
      diagnosis.posterior.push_back({other, false, std::exp(std::min(0.0, set.log_odds[k]))});
    }
  diagnosis.posterior.push_back({{}, true, oddsOfSomethingElse(diagnosis)});
  if (!stated.empty()) diagnosis.posterior.push_back({{}, false, oddsAgainst(diagnosis.log_odds)});
  for (const TestedCandidate& tested : diagnosis.tested)
    if (stated.empty() && tested.log_evidence > -kExcluded)
      diagnosis.posterior.push_back(
          {{tested.candidate}, false, std::exp(std::min(0.0, tested.log_evidence))});
  for (std::size_t i = 0; stated.size() > 1 && i < stated.size(); ++i) {
    std::vector<Candidate> rest = stated;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    diagnosis.posterior.push_back({rest, false, oddsAgainst(diagnosis.effects[i].log_odds)});
  }
  double sum = 0;
  for (const Hypothesis& hypothesis : diagnosis.posterior) sum += hypothesis.mass;
  for (Hypothesis& hypothesis : diagnosis.posterior) hypothesis.mass /= sum;
  stableSort(diagnosis.posterior, [](const Hypothesis& a, const Hypothesis& b) { return a.mass > b.mass; });
}

bool actsOn(std::size_t effect, Channel channel, const Linearization& linear) {
  for (std::size_t k = 0; k < linear.columns.size(); ++k) {
    if (linear.columns[k].effect != effect) continue;
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].channel == channel &&
          linear.C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) != 0)
        return true;
  }
  return false;
}

/// Where something else shows besides, what is named and acts on the same readings may be but what imitates
/// a part of it: the likelier, the more is left.
void doubtImitations(Diagnosis& diagnosis, const Linearization& nominal) {
  if (diagnosis.verdict != Verdict::unexplained || diagnosis.effects.empty()) return;
  const std::optional<Channel> channel = leftBeside(diagnosis).front().channel;
  double something_else = 0;
  for (const Hypothesis& hypothesis : diagnosis.posterior)
    if (hypothesis.is_something_else) something_else += hypothesis.mass;
  for (FoundEffect& found : diagnosis.effects)
    if (!channel || actsOn(found.candidate.effect, *channel, nominal))
      found.confidence *= 1 - diagnosis.remainder.share * something_else;
}

/// Whether a usual size of a candidate, its prior sigma, would have shown in the recording.
bool isWithinReach(const TestedCandidate& tested, const Linearization& nominal) {
  return std::any_of(tested.one_step.begin(), tested.one_step.end(), [&](const EffectEstimate& one) {
    for (const EffectColumn& column : nominal.columns)
      if (column.scalar == one.scalar)
        return one.sigma > 0 && std::pow(column.prior_sigma / one.sigma, 2) > kDetectable;
    return false;
  });
}

void judgeNothingFound(Diagnosis& diagnosis, const Linearization& nominal) {
  const auto within_reach = static_cast<std::size_t>(
      std::count_if(diagnosis.tested.begin(), diagnosis.tested.end(),
                    [&](const TestedCandidate& tested) { return isWithinReach(tested, nominal); }));
  if (static_cast<double>(within_reach) < kLeastShare * static_cast<double>(diagnosis.tested.size())) {
    diagnosis.verdict = Verdict::insufficient;
    diagnosis.why = print("Nothing shows, but of %zu things tried only %zu would have shown at a usual size.",
                          diagnosis.tested.size(), within_reach);
    return;
  }
  diagnosis.verdict = Verdict::none;
  diagnosis.why = print("Nothing material is missing: of %zu things tried the most telling, %s, would ",
                        diagnosis.tested.size(), diagnosis.most_improbable.c_str());
  diagnosis.why += print("be seen by chance with probability %.2g.", diagnosis.alarm_p);
}

}  // namespace

double oddsAgainst(double log_odds) { return std::exp(std::clamp(-log_odds, -kMostLogOdds, kMostLogOdds)); }

void judge(Diagnosis& diagnosis, const Linearization& nominal) {
  remarkOnNoise(diagnosis);
  remarkOnAllowance(diagnosis);
  diagnosis.budget = budgetOf(diagnosis.noise, nominal);
  shareOut(diagnosis);
  const std::vector<std::string> failures = failuresOf(diagnosis);
  if (!failures.empty()) diagnosis.verdict = Verdict::unexplained;
  weighHypotheses(diagnosis);
  doubtImitations(diagnosis, nominal);
  if (!failures.empty())
    tellUnexplained(diagnosis, failures);
  else if (!diagnosis.effects.empty())
    judgeExplained(diagnosis);
  else
    judgeNothingFound(diagnosis, nominal);
  remarkOnYardstick(diagnosis);
  tellAlternatives(diagnosis);
}

}  // namespace fathom
