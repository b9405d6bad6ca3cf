#pragma once

#include <cstdint>

#include "effects/registry.h"

namespace fathom {

/// Whether any of an effect's parameters is drawn anew for each image.
bool isDrawn(std::size_t effect);
/// Effects that are on, with spreads replaced by what is drawn of them for the image stamped t_s after the
/// recording's first entry: the same whenever seed and stamp are.
EffectParameters<double> drawnFor(const EffectParameters<double>& effects, std::uint64_t seed, double t_s);
/// As if none had been drawn: what is known of an image by itself.
EffectParameters<double> withoutDraws(const EffectParameters<double>& effects);

}  // namespace fathom
