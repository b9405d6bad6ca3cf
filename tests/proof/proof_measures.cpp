#include "proof_measures.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/median.h"
#include "core/random.h"
#include "core/text.h"

namespace fathom::proof {

using Kind = ProofCase::Kind;

bool isRight(const Scored& s) { return s.outcome == Outcome::right || s.outcome == Outcome::right_set; }
bool isNull(const Scored& s) { return s.proof_case.kind == Kind::null; }
bool isEffect(const Scored& s) { return s.proof_case.kind == Kind::effect; }
bool isOutside(const Scored& s) { return s.proof_case.kind == Kind::outside; }
bool isDecoy(const Scored& s) { return s.proof_case.kind == Kind::decoy; }
bool isAlone(const Scored& s) { return isEffect(s) || s.proof_case.kind == Kind::interval; }
bool needsSet(const Scored& s) {
  if (!isDecoy(s)) return false;
  const ProofCase::Effect& hidden = s.proof_case.effects[0];
  return std::count(hidden.inseparable.begin(), hidden.inseparable.end(), hidden.runner_up) > 0;
}

std::map<double, std::pair<double, double>> foundByStratum(const std::vector<Scored>& all) {
  std::map<double, std::pair<double, double>> counts;  // in set, all
  for (const Scored& s : all)
    if (isEffect(s)) {
      counts[s.proof_case.stratum].first += s.in_set ? 1 : 0;
      ++counts[s.proof_case.stratum].second;
    }
  return counts;
}

namespace {

using Choose = std::function<bool(const Scored&)>;

constexpr double kConfident = 0.9;  // from which on a name is stated with confidence
constexpr double kClear = 30;       // lambda (1 - c^2) of what can be seen to be outside the catalogue

/// sqrt(lambda) at which a test that gives a false alarm in a hundred recordings, having looked at 60 things,
/// finds half: the normal quantile of 0.01 / 60, both sides.
constexpr double kFisherHalf = 3.76;

/// Whether a stated set ("gamma | marker-moved 14") has an effect in it.
bool holds(const std::string& set, const std::string& id) {
  return ("| " + set + " ").find("| " + id + " ") != std::string::npos;
}
bool namesSomething(const Scored& s) { return !s.stated.empty(); }
/// Names beyond those that are true. Of what the catalogue lacks none is, but where it has a name since.
std::size_t namesTooMany(const Scored& s) {
  if (isOutside(s) && isRight(s)) return 0;
  return static_cast<std::size_t>(
      std::count_if(s.stated.begin(), s.stated.end(), [&](const std::string& set) {
        return std::none_of(s.proof_case.effects.begin(), s.proof_case.effects.end(),
                            [&](const ProofCase::Effect& effect) { return holds(set, effect.id); });
      }));
}
/// A single name, and a wrong one, however sure of it the answer is.
bool isOneWrongName(const Scored& s) { return namesSomething(s) && !s.in_set && s.set_size <= 1; }
/// A name by itself that is wrong, stated with confidence, and nothing that is right.
bool isConfidentlyWrong(const Scored& s) {
  return s.confidence >= kConfident && namesTooMany(s) == s.stated.size() &&
         std::any_of(s.stated.begin(), s.stated.end(),
                     [](const std::string& set) { return set.find('|') == std::string::npos; });
}
bool isFrom(const Scored& s, double least) { return isEffect(s) && s.proof_case.stratum >= least; }

/// So many of so many, with the 95 % interval of the share (Wilson 1927).
std::string share(std::size_t part, std::size_t whole) {
  if (whole == 0) return "-";
  const double n = static_cast<double>(whole), p = static_cast<double>(part) / n, z = 1.96;
  const double middle = (p + z * z / (2 * n)) / (1 + z * z / n),
               half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return print("%.1f %% (%zu of %zu; %.0f to %.0f %%)", 100 * p, part, whole,
               100 * std::max(0.0, middle - half), 100 * std::min(1.0, middle + half));
}

std::string shareOf(const std::vector<Scored>& all, const Choose& among, const Choose& what) {
  std::size_t part = 0, whole = 0;
  for (const Scored& s : all)
    if (among(s)) {
      ++whole;
      part += what(s) ? 1 : 0;
    }
  return share(part, whole);
}

double medianOf(std::vector<double> values) {
  return values.empty() ? std::nan("") : upperMedian(std::move(values));
}

/// sqrt(lambda) at which half of the effects are found, between strata linear in its logarithm; not a number
/// where no stratum is below it, or none above.
double halfPower(const std::vector<Scored>& all) {
  double before = 0, before_share = 0;
  for (const auto& [stratum, counts] : foundByStratum(all)) {
    const double found = counts.first / counts.second;
    if (found >= 0.5 && before == 0) break;
    if (found >= 0.5)
      return before * std::pow(stratum / before, (0.5 - before_share) / (found - before_share));
    before = stratum;
    before_share = found;
  }
  return std::nan("");
}

std::string setSize(const std::vector<Scored>& all) {
  double sum = 0, count = 0;
  for (const Scored& s : all)
    if (isFrom(s, 5) && s.in_set) {
      sum += s.set_size;
      ++count;
    }
  return count > 0 ? fixed(sum / count, 2) : "-";
}

std::string coverage(const std::vector<Scored>& all) {
  std::size_t covered = 0, scalars = 0;
  for (const Scored& s : all) {
    covered += static_cast<std::size_t>(s.covered);
    scalars += static_cast<std::size_t>(s.scalars);
  }
  return share(covered, scalars);
}

/// Of what was rightly named, on another dive.
std::vector<const Gains*> gainsOf(const std::vector<Scored>& all) {
  std::vector<const Gains*> gains;
  for (const Scored& s : all)
    if (s.gains && isFrom(s, 8) && isRight(s) && s.gains->truth > 0) gains.push_back(&*s.gains);
  return gains;
}

/// The share of all that the truth gains, and that of the middle recording.
std::string gainShare(const std::vector<Scored>& all, double Gains::*what) {
  double part = 0, whole = 0;
  std::vector<double> shares;
  for (const Gains* gains : gainsOf(all)) {
    part += gains->*what;
    whole += gains->truth;
    shares.push_back(gains->*what / gains->truth);
  }
  if (shares.empty()) return "-";
  return print("%.1f %% of all; median %.1f %% (%zu recordings)", 100 * part / whole, 100 * medianOf(shares),
               shares.size());
}

/// Of what was rightly named: how far its parameters are off, a share of their size.
std::string parametersOff(const std::vector<Scored>& all) {
  std::vector<double> off;
  for (const Scored& s : all)
    if (s.parameters_off && isFrom(s, 8) && isRight(s)) off.push_back(*s.parameters_off);
  return off.empty() ? "-" : print("%.1f %% (%zu recordings)", 100 * medianOf(off), off.size());
}

/// By how much what was stated gains more than a black box on another dive, a share of what the truth gains:
/// the median, and its 95 % interval by the bootstrap over recordings (Efron 1979).
std::string overBlackBox(const std::vector<Scored>& all) {
  std::vector<double> shares;
  for (const Gains* gains : gainsOf(all)) shares.push_back((gains->stated - gains->black_box) / gains->truth);
  if (shares.empty()) return "-";
  constexpr std::size_t kDraws = 2000;
  Random random(1);
  std::vector<double> medians;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    std::vector<double> drawn;
    for (std::size_t i = 0; i < shares.size(); ++i) drawn.push_back(shares[random.bits() % shares.size()]);
    medians.push_back(medianOf(std::move(drawn)));
  }
  std::sort(medians.begin(), medians.end());
  return print("%.1f %% (%.1f to %.1f %%; %zu recordings)", 100 * medianOf(shares),
               100 * medians[kDraws / 40], 100 * medians[kDraws - 1 - kDraws / 40], shares.size());
}

/// By tenths of the confidence: how far the share that is right is from it, weighted by how many there are.
std::string calibrationError(const std::vector<Scored>& all) {
  std::map<int, std::array<double, 3>> bins;  // count, confidence, right
  double total = 0;
  for (const Scored& s : all) {
    if (s.confidence <= 0 || s.proof_case.kind == Kind::pair) continue;
    auto& bin = bins[static_cast<int>(10 * s.confidence)];
    ++bin[0];
    bin[1] += s.confidence;
    bin[2] += s.first_right ? 1 : 0;
    ++total;
  }
  double error = 0;
  for (const auto& [tenth, bin] : bins) error += std::abs(bin[1] - bin[2]) / total;
  return total > 0 ? print("%.3f (%.0f answers)", error, total) : "-";
}

/// Beginnings or ends that are stated to within 2 s, of those that are rightly named.
std::string onTime(const std::vector<Scored>& all, std::optional<double> Scored::*off_s) {
  return shareOf(
      all, [&](const Scored& s) { return s.*off_s && isAlone(s) && s.proof_case.stratum >= 8; },
      [&](const Scored& s) { return *(s.*off_s) <= 2; });
}

}  // namespace

Series fisherLimit() {
  Series limit{.name = "Fisher limit"};
  for (double log_size = 1; log_size <= 5; log_size += 0.05) {
    limit.x.push_back(log_size);
    limit.y.push_back(50 * std::erfc((kFisherHalf - std::exp2(log_size)) / std::sqrt(2.0)));
  }
  return limit;
}

Table measureTable(const std::vector<Scored>& all) {
  const auto effectsFrom = [](double least) { return [least](const Scored& s) { return isFrom(s, least); }; };
  const auto isOfStratum = [](double stratum) {
    return [stratum](const Scored& s) { return isEffect(s) && s.proof_case.stratum == stratum; };
  };
  const auto anyKind = [](const Scored&) { return true; };
  const auto isDistinct = [](const Scored& s) {
    return isOutside(s) && s.proof_case.left >= kClear && s.proof_case.left >= 0.5 * s.proof_case.lambda;
  };
  const auto isAlias = [](const Scored& s) {
    return isOutside(s) && s.proof_case.left >= kClear && s.proof_case.left < 0.5 * s.proof_case.lambda;
  };
  const auto isRightFrom8 = [](const Scored& s) { return isFrom(s, 8) && isRight(s) && s.own; };
  const auto isUnexplained = [](const Scored& s) { return s.outcome == Outcome::unexplained; };
  const auto isSaid = [&](const Scored& s) { return isUnexplained(s) || isRight(s); };
  const double half = halfPower(all);
  Table table{{"measure", "target", "reached"}, {}};
  table.rows = {
      {"false alarms on recordings that hide nothing", "at most 2 %", shareOf(all, isNull, namesSomething)},
      {"effect size at half power over the Fisher limit", "at most 1.12",
       std::isnan(half) ? "-"
                        : print("%.2f (sqrt lambda %.1f over %.2f)", half / kFisherHalf, half, kFisherHalf)},
      {"right name (first) where lambda (1 - c) >= 5.4, sqrt lambda >= 5", "96 %",
       shareOf(
           all, [](const Scored& s) { return isFrom(s, 5) && s.proof_case.effects[0].nearest >= kSeparable; },
           [](const Scored& s) { return s.first_right; })},
      {"truth in the stated set, sqrt lambda >= 5", "93 %",
       shareOf(all, effectsFrom(5), [](const Scored& s) { return s.in_set; })},
      {"right name alone or in a set that has to be one, sqrt lambda 8", "95 %",
       shareOf(all, isOfStratum(8), isRight)},
      {"the same, 16", "98 %", shareOf(all, isOfStratum(16), isRight)},
      {"the same, 32", "99 %", shareOf(all, isOfStratum(32), isRight)},
      {"mean size of the set", "at most 1.35", setSize(all)},
      {"answers that are sets", "",
       shareOf(
           all, [](const Scored& s) { return namesSomething(s) && !isNull(s); },
           [](const Scored& s) { return s.set_size > 1; })},
      {"both of two effects, each sqrt lambda >= 10", "95 %",
       shareOf(
           all, [](const Scored& s) { return s.proof_case.kind == Kind::pair; },
           [](const Scored& s) { return s.in_set; })},
      {"outside the catalogue, distinct: unexplained", "90 %", shareOf(all, isDistinct, isSaid)},
      {"outside the catalogue, near-alias: unexplained", "70 %", shareOf(all, isAlias, isSaid)},
      {"false \"unexplained\"", "at most 3 %",
       shareOf(
           all, [](const Scored& s) { return !isOutside(s); }, isUnexplained)},
      {"95 % intervals that cover", "92 to 98 %", coverage(all)},
      {"parameters of what is rightly named are off by, median, sqrt lambda >= 8", "", parametersOff(all)},
      {"held out on its own stretches: gains more than a placebo, sqrt lambda >= 8", "",
       shareOf(all, isRightFrom8, [](const Scored& s) { return s.own->physics > s.own->placebo; })},
      {"the same: more than a black box, interval above 0", "",
       shareOf(all, isRightFrom8, [](const Scored& s) { return s.own->over_black_box > 0; })},
      {"gain on another dive, share of what the truth gains", "95 %", gainShare(all, &Gains::stated)},
      {"the same of a black box", "less", gainShare(all, &Gains::black_box)},
      {"the same over a black box, median", "interval above 0", overBlackBox(all)},
      {"the same of the runner-up", "less", gainShare(all, &Gains::runner_up)},
      {"right name (first) where an effect is on for a part", "95 %",
       shareOf(
           all, [](const Scored& s) { return s.proof_case.kind == Kind::interval; },
           [](const Scored& s) { return s.first_right; })},
      {"onset within 2 s, sqrt lambda >= 8", "97 %", onTime(all, &Scored::onset_off_s)},
      {"end within 2 s, sqrt lambda >= 8", "all", onTime(all, &Scored::end_off_s)},
      {"decoys: truth in the stated set", "98 %",
       shareOf(all, isDecoy, [](const Scored& s) { return s.in_set; })},
      {"decoys: a set with both where it has to be one", "90 %",
       shareOf(all, needsSet, [](const Scored& s) { return s.in_set && s.rival_in_set; })},
      {"decoys: a confident wrong name", "none", shareOf(all, isDecoy, isOneWrongName)},
      {"all kinds: a confident wrong name", "at most 1 %", shareOf(all, anyKind, isConfidentlyWrong)},
      {"all kinds: names beyond what is true", "",
       shareOf(all, anyKind, [](const Scored& s) { return namesTooMany(s) > 0; })},
      {"sets that the advised manoeuvre leaves the truth alone of", "85 %",
       shareOf(
           all, [](const Scored& s) { return s.advised.has_value(); },
           [](const Scored& s) { return s.advised->outcome == Outcome::right; })},
      {"calibration error of the stated confidence", "at most 0.08", calibrationError(all)}};
  return table;
}

}  // namespace fathom::proof
