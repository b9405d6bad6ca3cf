#pragma once

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "effects/catalogue.h"

/// Effects of any registry, switched on.
namespace fathom::test {

inline constexpr double kNow_s = 20;
inline constexpr int kMarkersThere[] = {3, 14};
inline constexpr int kMiddleRegion = 4;

/// One effect, its continuous parameters one prior sigma large, its marker one of kMarkersThere and its time
/// past.
inline void switchOn(const EffectInfo& effect, EffectParameters<double>& parameters) {
  parameters.on.set(effect.index);
  std::size_t i = effect.first_scalar;
  for (const Parameter& p : effect.parameters)
    for (int k = 0; k < p.size; ++k)
      parameters.values[i++] = p.kind == ParameterKind::marker_id   ? kMarkersThere[0]
                               : p.kind == ParameterKind::sensor    ? 1
                               : p.kind == ParameterKind::region    ? kMiddleRegion
                               : p.kind == ParameterKind::time      ? kNow_s / 2
                               : p.kind == ParameterKind::peak_time ? kNow_s - 5
                                                                    : p.prior_sigma;
}

/// All effects at once, a few prior sigmas large.
inline EffectParameters<double> randomEffects(Random& random) {
  EffectParameters<double> parameters;
  for (const EffectInfo& effect : allEffects()) {
    switchOn(effect, parameters);
    std::size_t i = effect.first_scalar;
    for (const Parameter& p : effect.parameters)
      for (int k = 0; k < p.size; ++k, ++i)
        if (p.kind == ParameterKind::continuous || p.kind == ParameterKind::log_width) {
          const double size = parameters.values[i] * random.normal();
          parameters.values[i] = p.positive ? std::abs(size) : size;
          if (!p.squared) parameters.values[i] = std::clamp(parameters.values[i], -p.limit, p.limit);
        }
  }
  return parameters;
}

}  // namespace fathom::test
