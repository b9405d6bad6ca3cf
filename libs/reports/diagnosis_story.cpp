#include "reports/diagnosis_story.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "effects/catalogue.h"
#include "effects/parameter_words.h"

namespace fathom {
namespace {

/// Of one parameter, what was estimated of it; empty where nothing was.
std::vector<double> sigmasOf(const FoundEffect& effect, std::size_t first_scalar, int size) {
  std::vector<double> sigma;
  for (const EffectEstimate& e : effect.estimates)
    if (e.effect == effect.candidate.effect && e.scalar >= first_scalar &&
        e.scalar < first_scalar + static_cast<std::size_t>(size))
      sigma.push_back(sigmaAsNamed(parameterOf(e.scalar), e.value, e.sigma));
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
  for (double& value : values) value = asNamed(parameter, value);
  return values;
}

DerivedFrom derivedFrom(const DiagnosisStory& story) {
  const BatchEstimate& estimate = story.diagnosis.after;
  const BatchData& data = story.read.input.data;
  DerivedFrom from{estimate.state.water.head<3>()};
  if (!data.vehicle.camera || data.panels.empty() || estimate.path.empty()) return from;
  double sum_m = 0;
  for (const PathPose& pose : estimate.path)
    sum_m += (pose.T_odom_robot.pose * data.vehicle.camera->T_robot_camera.position).z();
  from.camera_over_panel_m =
      sum_m / static_cast<double>(estimate.path.size()) - data.panels.front().T_odom_panel.position.z();
  return from;
}

}  // namespace

std::vector<FoundParameter> parametersOf(const FoundEffect& effect, const DiagnosisStory& story) {
  const BatchState& state = story.diagnosis.after.state;
  const EffectParameters<double>& calibration = state.effects;
  const EffectInfo& info = allEffects()[effect.candidate.effect];
  std::vector<FoundParameter> parameters;
  std::size_t scalar = info.first_scalar;
  for (const Parameter& p : info.parameters) {
    parameters.push_back({std::string(p.name), std::string(p.unit), valuesOf(effect, p, scalar, calibration),
                          sigmasOf(effect, scalar, p.size)});
    if (const auto words = wordsOf(p.kind); !words.empty())
      parameters.back().word = words[static_cast<std::size_t>(parameters.back().value[0])];
    scalar += static_cast<std::size_t>(p.size);
  }
  if (info.derived != nullptr) {
    const Vector3d value = info.derive(calibration.values.data() + info.first_scalar, derivedFrom(story));
    parameters.push_back({std::string(info.derived->name),
                          std::string(info.derived->unit),
                          {value.begin(), value.begin() + info.derived->size},
                          {}});
  }
  return parameters;
}

std::string textOf(const FoundParameter& parameter) {
  if (!parameter.word.empty()) return parameter.word;
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < parameter.value.size(); ++i)
    numbers.push_back(plusMinus(parameter.value[i], i < parameter.sigma.size() ? parameter.sigma[i] : 0));
  std::string text;
  for (const std::string& number : numbers) text += (text.empty() ? "" : ", ") + number;
  if (numbers.size() > 1) text = "[" + text + "]";
  return parameter.unit == "1" ? text : text + " " + parameter.unit;
}

std::optional<Interval> activeIn(const Candidate& candidate, const BatchData& data) {
  if (!candidate.peak) return within(candidate.active_s, data);
  const auto& [time_s, width_s] = *candidate.peak;
  return within({time_s - 2 * width_s, time_s + 2 * width_s}, data);
}

std::optional<Interval> within(const Interval& interval, const BatchData& data) {
  if (interval == Interval{}) return {};
  return Interval{std::max(interval.from_s, data.first_s), std::min(interval.to_s, data.last_s),
                  interval.pauses};
}

std::string textOf(const std::optional<Interval>& interval) {
  if (!interval) return "always";
  std::string text;
  for (const auto& [from_s, to_s] : interval->parts())
    text += (text.empty() ? "" : ", ") + print("%.1f to %.1f", from_s, to_s);
  return text + " s";
}

std::string probabilityText(double log_p) {
  if (!std::isfinite(log_p)) return log_p < 0 ? "0" : "-";
  const double log10_p = log_p / std::log(10.0);
  if (log10_p > -4) return fixed(std::exp(log_p), 4);
  const double exponent = std::floor(log10_p);
  return print("%.1fe%.0f", std::pow(10.0, log10_p - exponent), exponent);
}

bool isSignificant(const Mismatch& mismatch, double false_alarm) { return mismatch.p_value < false_alarm; }

std::string sensorOf(const Mismatch& mismatch) {
  std::string channel = nameOf(mismatch.channel);
  if (mismatch.direction.empty() || textOf(mismatch.channel).component_count == 1) return channel;
  return channel + (mismatch.channel == kChannel<Markers> ? ", " : " ") + mismatch.direction;
}

std::string shareText(double share) { return print("%.*f %%", share < 0.1 ? 1 : 0, 100 * share); }

Table effectTable(const DiagnosisStory& story) {
  Table table{{"effect", "parameter", "value ± sigma", "when", "size [sqrt lambda]", "confidence", "share"},
              {}};
  for (const FoundEffect& effect : story.diagnosis.effects) {
    bool first = true;
    for (const FoundParameter& parameter : parametersOf(effect, story)) {
      table.rows.push_back({first ? nameOf(effect.candidate) : "", parameter.name, textOf(parameter)});
      if (first)
        table.rows.back().insert(
            table.rows.back().end(),
            {textOf(activeIn(effect.candidate, story.read.input.data)), fixed(effect.sqrt_lambda, 1),
             effect.confidence > 0.99 ? "> 99 %" : print("%.0f %%", 100 * effect.confidence),
             shareText(effect.share)});
      first = false;
    }
  }
  return table;
}

Table heldOutTable(const HeldOutResult& heldout) {
  Table table{{"metric", "before", "after", "95 % of it", "black box", "noise alone"}, {}};
  for (const HeldOut& h : heldout.channels)
    table.rows.push_back({h.metric, print("%.4g", h.before), print("%.4g", h.after),
                          print("%.4g to %.4g", h.after_ci95[0], h.after_ci95[1]), print("%.4g", h.black_box),
                          print("%.4g", h.noise_floor)});
  return table;
}

Table elsewhereTable(const DiagnosisStory& story) {
  Table table{{"recording", "metric", "before", "after", "black box", "log likelihood", "of the black box"},
              {}};
  for (const auto& [recording, judged] : story.elsewhere) {
    const std::string name = recording.filename().string();
    if (judged.failure.empty() && !judged.channels.empty()) {
      const ElsewhereChannel& c = judged.channels.front();
      table.rows.push_back({name, c.metric, print("%.4g", c.before), print("%.4g", c.after),
                            print("%.4g", c.black_box), print("%+.1f", judged.physics),
                            print("%+.1f", judged.black_box)});
    } else {
      table.rows.push_back({name, judged.failure, "", "", "", "", ""});
    }
  }
  return table;
}

bool hasWater(const DiagnosisStory& story) {
  return !story.read.input.data.patches.empty() && story.diagnosis.after.succeeded;
}

std::string simulateCommand(const DiagnosisStory& story) {
  if (!story.read.input.data.hasMotion()) return "";
  const auto in_folder = [&](const char* name) { return shellWord((story.folder / name).string()); };
  std::string command = "fathom simulate --trajectory " + in_folder("trajectory.tum") + " --vehicle " +
                        shellWord(story.read.vehicle.string());
  if (story.read.map) command += " --map " + shellWord(story.read.map->string());
  if (hasWater(story)) command += " --water " + in_folder("water.yaml");
  return command + " --calibration " + in_folder("calibration.yaml") + " --out " + in_folder("simulated");
}

}  // namespace fathom
