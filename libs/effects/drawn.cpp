#include "effects/drawn.h"

#include <bit>

#include "core/fingerprint.h"
#include "core/random.h"
#include "effects/catalogue.h"

namespace fathom {

bool isDrawn(std::size_t effect) { return allEffects()[effect].has(ParameterKind::spread); }

namespace {

/// Effects that are on, each spread times what `factor` gives for its scalar.
template <class Factor>
EffectParameters<double> withSpreadsTimes(EffectParameters<double> effects, Factor factor) {
  for (std::size_t e = 0; e < kEffectCount; ++e)
    for (std::size_t s = kEffectOffsets[e]; effects.on[e] && s < kEffectOffsets[e + 1]; ++s)
      if (parameterOf(s).kind == ParameterKind::spread) effects.values[s] *= factor(s);
  return effects;
}

}  // namespace

EffectParameters<double> withoutDraws(const EffectParameters<double>& effects) {
  return withSpreadsTimes(effects, [](std::size_t) { return 0.0; });
}

EffectParameters<double> drawnFor(const EffectParameters<double>& effects, std::uint64_t seed, double t_s) {
  return withSpreadsTimes(effects, [&](std::size_t scalar) {
    // By name: another effect in the catalogue, or another parameter, changes no draw.
    const std::string_view effect = allEffects()[effectOf(scalar)].id;
    const Parameter& parameter = parameterOf(scalar);
    Fingerprint stream = Fingerprint().add(effect).add(".").add(parameter.name);
    if (parameter.size > 1) stream.add(static_cast<double>(scalar - kEffectOffsets[effectOf(scalar)]));
    return Random::stream(seed ^ std::bit_cast<std::uint64_t>(t_s), stream.value()).normal();
  });
}

}  // namespace fathom
