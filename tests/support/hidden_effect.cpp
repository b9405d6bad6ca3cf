#include "support/hidden_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/image_regions.h"
#include "effects/sensor_kinds.h"

namespace fathom::test {
namespace {

/// Whose clock may drift: of what every dive has.
constexpr std::array kClocks{sensorKind("INS"), sensorKind("DVL"), sensorKind("CAMERA")};

/// Nothing is less than nothing, the intrinsics are those of a calibration under water, and there is water
/// all the way.
void makePossible(const EffectInfo& effect, EffectParameters<double>& effects) {
  for (std::size_t s = effect.first_scalar; s < effect.first_scalar + effect.scalars; ++s)
    if (!isPossible(parameterOf(s), effects.values[s])) effects.values[s] = -effects.values[s];
  if (effect.index != kEffectIndex<FlatPortRefraction>) return;
  double* port = effects.of<FlatPortRefraction>();
  port[0] = std::abs(port[0]);
  port[1] = std::abs(port[1]);
  port[4] = 0;
  port[5] = 0;
}

}  // namespace

Hidden randomEffect(const EffectInfo& effect, const std::vector<int>& marker_ids, double duration_s,
                    Random& random) {
  Hidden hidden;
  hidden.candidate.effect = effect.index;
  hidden.effects.on.set(effect.index);
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& parameter : effect.parameters)
    for (int i = 0; i < parameter.size; ++i, ++scalar) {
      double& value = hidden.effects.values[scalar];
      if (isSize(parameter.kind) || parameter.kind == ParameterKind::shape)
        value = parameter.prior_sigma * random.normal();
      if (parameter.kind == ParameterKind::peak_time) value = duration_s * random.uniform(0.25, 0.75);
      if (parameter.kind == ParameterKind::log_width)
        value = std::log(duration_s * random.uniform(0.05, 0.15) / parameter.usual_width_s);
      if (parameter.kind == ParameterKind::marker_id)
        value = *(hidden.candidate.marker_id = marker_ids[random.bits() % marker_ids.size()]);
      if (parameter.kind == ParameterKind::region)
        value = *(hidden.candidate.region = static_cast<int>(random.bits() % kImageRegions.size()));
      if (parameter.kind == ParameterKind::sensor)
        value = *(hidden.candidate.sensor = kClocks[random.bits() % kClocks.size()]);
      if (parameter.kind == ParameterKind::time)
        value = *(hidden.candidate.time_s = duration_s * random.uniform(0.25, 0.75));
    }
  if (hasPeak(effect)) hidden.candidate.peak = peakOf(hidden.effects, effect.index);
  makePossible(effect, hidden.effects);
  return hidden;
}

Interval randomInterval(double duration_s, Random& random) {
  const double from_s = duration_s * random.uniform(0.1, 0.4);
  return {from_s, from_s + duration_s * random.uniform(0.3, 0.5)};
}

Hidden activeDuring(Hidden hidden, const Interval& active_s) {
  hidden.candidate.active_s = hidden.effects.active_s[hidden.candidate.effect] = active_s;
  return hidden;
}

EffectParameters<double> scaled(EffectParameters<double> effects, double factor) {
  for (std::size_t s = 0; s < effects.values.size(); ++s)
    if (effects.on[effectOf(s)] && isSize(parameterOf(s).kind)) effects.values[s] *= factor;
  return effects;
}

bool isWithinLimits(const EffectParameters<double>& effects) {
  for (std::size_t s = 0; s < effects.values.size(); ++s)
    if (effects.on[effectOf(s)] &&
        std::abs(asNamed(parameterOf(s), effects.values[s])) > parameterOf(s).limit)
      return false;
  return true;
}

std::vector<Candidate> candidatesOf(const EffectInfo& effect, const std::vector<int>& marker_ids,
                                    const Interval& span) {
  std::vector<Candidate> all;
  Candidate candidate;
  candidate.effect = effect.index;
  const auto addTenths = [&](const auto& at) {
    for (int k = 1; k < 10; ++k) {
      at(span.from_s + 0.1 * k * (span.to_s - span.from_s));
      all.push_back(candidate);
    }
  };
  if (effect.has(ParameterKind::marker_id))
    for (const int id : marker_ids) {
      candidate.marker_id = id;
      all.push_back(candidate);
    }
  else if (effect.has(ParameterKind::region))
    for (std::size_t region = 0; region < kImageRegions.size(); ++region) {
      candidate.region = static_cast<int>(region);
      all.push_back(candidate);
    }
  else if (effect.has(ParameterKind::sensor))
    for (const int sensor : kClocks) {
      candidate.sensor = sensor;
      all.push_back(candidate);
    }
  else if (hasPeak(effect))
    addTenths([&](double t_s) { candidate.peak = Peak{t_s, 0.1 * (span.to_s - span.from_s)}; });
  else if (effect.has(ParameterKind::time))
    addTenths([&](double t_s) { candidate.time_s = t_s; });
  else
    all.push_back(candidate);
  return all;
}

}  // namespace fathom::test
