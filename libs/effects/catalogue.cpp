#include "effects/catalogue.h"

#include <algorithm>
#include <cmath>

#include "effects/registry.h"

namespace fathom {

bool EffectInfo::has(ParameterKind kind) const {
  return std::any_of(parameters.begin(), parameters.end(),
                     [&](const Parameter& p) { return p.kind == kind; });
}

std::vector<std::string_view> EffectInfo::confusedWith() const {
  const auto& ids = text.confused_with;
  return {ids.begin(), std::find(ids.begin(), ids.end(), std::string_view())};
}

const std::vector<EffectInfo>& allEffects() {
  static const std::vector<EffectInfo> effects = [] {
    std::vector<EffectInfo> all;
    forEachEffect([&]<class Effect>() {
      constexpr std::size_t index = kEffectIndex<Effect>;
      all.push_back({Effect::id, Effect::text, Effect::parameters, index, kEffectOffsets[index],
                     parameterSize<Effect>()});
      all.back().is_of_instrument = !kIsOfWorld<typename Effect::template Stage<double>> && !requires {
        Effect::is_of_world;
      };
      if constexpr (requires { Effect::derived; }) {
        all.back().derived = &Effect::derived;
        all.back().derive = &Effect::derive;
      }
    });
    return all;
  }();
  return effects;
}

const Parameter& parameterOf(std::size_t scalar) {
  static const std::vector<const Parameter*> all = [] {
    std::vector<const Parameter*> list;
    for (const EffectInfo& effect : allEffects())
      for (const Parameter& p : effect.parameters)
        list.insert(list.end(), static_cast<std::size_t>(p.size), &p);
    return list;
  }();
  return *all.at(scalar);
}

std::size_t effectOf(std::size_t scalar) {
  const auto behind = std::upper_bound(kEffectOffsets.begin(), kEffectOffsets.end(), scalar);
  return static_cast<std::size_t>(behind - kEffectOffsets.begin()) - 1;
}

double sizeOf(std::size_t scalar, double value) { return isSize(parameterOf(scalar).kind) ? value : 0; }

double asNamed(const Parameter& parameter, double value) {
  if (parameter.at_zero > 0) return parameter.at_zero * std::exp(value);
  return parameter.squared ? std::sqrt(std::max(0.0, value)) : value;
}

double asHeld(const Parameter& parameter, double named) {
  if (parameter.at_zero > 0) return std::log(named / parameter.at_zero);
  return parameter.squared ? named * named : named;
}

/// Where less than nothing is as likely as more, the root has no derivative: then the root of the largest
/// value that is still likely.
double sigmaAsNamed(const Parameter& parameter, double value, double sigma) {
  if (parameter.at_zero > 0) return asNamed(parameter, value) * sigma;
  return parameter.squared ? sigma / std::sqrt(4 * std::max(value, 0.25 * sigma)) : sigma;
}

bool isPossible(const Parameter& parameter, double value) { return !parameter.positive || value >= 0; }

const EffectInfo* findEffect(std::string_view id) {
  for (const EffectInfo& effect : allEffects())
    if (effect.id == id) return &effect;
  return nullptr;
}

std::string knownEffects() {
  std::string known;
  for (const EffectInfo& effect : allEffects()) known.append(known.empty() ? "" : ", ").append(effect.id);
  return known;
}

std::string_view nameOf(EffectChannel channel) {
  switch (channel) {
    case EffectChannel::navigation:
      return "navigation";
    case EffectChannel::marker_geometry:
      return "marker geometry";
    case EffectChannel::image:
      break;
  }
  return "image";
}

std::string_view nameOf(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::continuous:
      return "continuous";
    case ParameterKind::marker_id:
      return "marker id";
    case ParameterKind::sensor:
      return "sensor";
    case ParameterKind::region:
      return "region";
    case ParameterKind::time:
      return "time";
    case ParameterKind::peak_time:
      return "peak time";
    case ParameterKind::log_width:
      return "log width";
    case ParameterKind::shape:
      return "shape";
    case ParameterKind::spread:
      break;
  }
  return "spread";
}

}  // namespace fathom
