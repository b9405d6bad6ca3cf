#include "diagnosis_story.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "effects/catalogue.h"
#include "shell_word.h"

namespace fathom {
namespace {

/// So many digits behind the point that sigma has two that count.
int decimalsFor(double sigma) {
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9);
}

std::string plusMinusText(double value, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) return print("%.6g", value);
  const int decimals = decimalsFor(sigma);
  return fixed(value, decimals) + " ± " + fixed(sigma, decimals);
}

/// Of one parameter, what was estimated of it; empty where nothing was.
std::vector<double> sigmasOf(const FoundEffect& effect, std::size_t first_scalar, int size) {
  std::vector<double> sigma;
  for (const EffectEstimate& e : effect.estimates)
    if (e.effect == effect.candidate.effect && e.scalar >= first_scalar &&
        e.scalar < first_scalar + static_cast<std::size_t>(size))
      sigma.push_back(e.sigma);
  return sigma;
}

std::vector<double> valuesOf(const FoundEffect& effect, const Parameter& parameter, std::size_t first_scalar,
                             const EffectParameters<double>& calibration) {
  const Candidate& candidate = effect.candidate;
  if (parameter.kind == ParameterKind::marker_id && candidate.marker_id)
    return {static_cast<double>(*candidate.marker_id)};
  if (parameter.kind == ParameterKind::time && candidate.time_s) return {*candidate.time_s};
  const double* first = calibration.values.data() + first_scalar;
  std::vector<double> values(first, first + parameter.size);
  for (const EffectEstimate& e : effect.estimates)
    if (e.scalar >= first_scalar && e.scalar < first_scalar + values.size())
      values[e.scalar - first_scalar] = e.value;
  return values;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

/// "dvl-scale", or "dvl-scale or marker-size" where the recording cannot choose.
std::string namesOf(const FoundEffect& effect, const std::vector<Alternatives>& alternatives) {
  std::string text = nameOf(effect.candidate);
  for (const Alternatives& set : alternatives)
    if (!set.candidates.empty() && set.candidates[0] == effect.candidate)
      for (std::size_t i = 1; i < set.candidates.size(); ++i) text += " or " + nameOf(set.candidates[i]);
  return text;
}

std::string bandText(const std::array<double, 2>& band) { return print("%.4g to %.4g", band[0], band[1]); }

}  // namespace

std::vector<FoundParameter> parametersOf(const FoundEffect& effect,
                                         const EffectParameters<double>& calibration) {
  const EffectInfo& info = allEffects()[effect.candidate.effect];
  std::vector<FoundParameter> parameters;
  std::size_t scalar = info.first_scalar;
  for (const Parameter& p : info.parameters) {
    parameters.push_back({std::string(p.name), std::string(p.unit), valuesOf(effect, p, scalar, calibration),
                          sigmasOf(effect, scalar, p.size)});
    scalar += static_cast<std::size_t>(p.size);
  }
  return parameters;
}

std::string textOf(const FoundParameter& parameter) {
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < parameter.value.size(); ++i)
    numbers.push_back(plusMinusText(parameter.value[i], i < parameter.sigma.size() ? parameter.sigma[i] : 0));
  std::string text;
  for (const std::string& number : numbers) text += (text.empty() ? "" : ", ") + number;
  if (numbers.size() > 1) text = "[" + text + "]";
  return parameter.unit == "1" ? text : text + " " + parameter.unit;
}

std::optional<Interval> within(const Interval& interval, const BatchData& data) {
  if (interval == Interval{}) return {};
  return Interval{std::max(interval.from_s, data.first_s), std::min(interval.to_s, data.last_s)};
}

std::string textOf(const std::optional<Interval>& interval) {
  return interval ? print("%.1f to %.1f s", interval->from_s, interval->to_s) : "always";
}

bool isSignificant(const Mismatch& mismatch, double false_alarm) { return mismatch.p_value < false_alarm; }

std::string sensorOf(const Mismatch& mismatch) {
  const std::string channel = nameOf(mismatch.channel);
  if (mismatch.component < 0) return channel;
  if (mismatch.channel == BatchChannel::markers)
    return channel + (mismatch.component == 0   ? ", radial"
                      : mismatch.component == 1 ? ", tangential"
                                                : print(", component %d", mismatch.component));
  if (mismatch.channel == BatchChannel::depth) return channel;
  return channel + " " + std::string(1, "xyz"[mismatch.component % 3]);
}

std::string headlineOf(const Diagnosis& diagnosis) {
  switch (diagnosis.verdict) {
    case Verdict::none:
      return "Nothing that matters is missing from the model.";
    case Verdict::insufficient:
      return "This recording cannot show it either way.";
    case Verdict::explained:
    case Verdict::unexplained:
      break;
  }
  std::vector<std::string> names;
  for (const FoundEffect& effect : diagnosis.effects)
    names.push_back(namesOf(effect, diagnosis.alternatives));
  std::string missing = "Missing from the model: " + listed(names);
  if (!diagnosis.alternatives.empty()) missing += " (this recording cannot choose)";
  if (diagnosis.verdict == Verdict::explained) return missing + ".";
  const std::string none_of_these = "none of the effects that are known here";
  if (names.empty()) return "Something is missing from the model, and it is " + none_of_these + ".";
  return missing + "; and something else that is " + none_of_these + ".";
}

Table effectTable(const DiagnosisStory& story) {
  Table table{{"effect", "parameter", "value ± sigma", "when", "size [sqrt lambda]"}, {}};
  for (const FoundEffect& effect : story.diagnosis.effects) {
    bool first = true;
    for (const FoundParameter& parameter : parametersOf(effect, story.diagnosis.calibration)) {
      table.rows.push_back({first ? nameOf(effect.candidate) : "", parameter.name, textOf(parameter)});
      if (first)
        table.rows.back().insert(
            table.rows.back().end(),
            {textOf(within(effect.candidate.active_s, story.read.input.data)), fixed(effect.sqrt_lambda, 1)});
      first = false;
    }
  }
  return table;
}

Table heldOutTable(const Diagnosis& diagnosis) {
  Table table{{"metric", "before", "after", "95 % of it", "black box", "noise alone"}, {}};
  for (const HeldOut& h : diagnosis.heldout)
    table.rows.push_back({h.metric, print("%.4g", h.before), print("%.4g", h.after), bandText(h.after_ci95),
                          print("%.4g", h.black_box), print("%.4g", h.noise_floor)});
  return table;
}

Table heldOutGainTable(const Diagnosis& diagnosis) {
  Table table{{"metric", "effects", "95 % of it", "black box", "placebo"}, {}};
  for (const HeldOut& h : diagnosis.heldout)
    table.rows.push_back({h.metric, fixed(h.log_likelihood_gain, 1), bandText(h.gain_ci95),
                          fixed(h.black_box_log_likelihood_gain, 1),
                          fixed(h.placebo_log_likelihood_gain, 1)});
  return table;
}

std::string simulateCommand(const DiagnosisStory& story) {
  if (!story.read.input.data.hasMotion()) return "";
  const auto in_folder = [&](const char* name) { return shellWord((story.folder / name).string()); };
  std::string command = "fathom simulate --trajectory " + in_folder("trajectory.tum") + " --vehicle " +
                        shellWord(story.read.vehicle.string());
  if (story.read.map) command += " --map " + shellWord(story.read.map->string());
  return command + " --calibration " + in_folder("calibration.yaml") + " --out " + in_folder("simulated");
}

}  // namespace fathom
