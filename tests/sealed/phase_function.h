#pragma once

#include <functional>

#include "sealed_case.h"

namespace fathom::sealed {

/// How water scatters light by an angle of this cosine, over what it would be if it scattered alike in all
/// directions: 1 in the mean over the sphere.
using PhaseFunction = std::function<double(double cosine)>;

/// Henyey & Greenstein 1941; asymmetry: the mean cosine.
PhaseFunction henyeyGreenstein(double asymmetry);
/// Particles of one refractive index (over water's) whose sizes go with a power of this slope (Fournier &
/// Forand 1994, as Fournier & Jonasz 1999 have it). Sea water: 1.05 to 1.15, 3.5 to 3.9.
PhaseFunction fournierForand(double index, double slope);
/// What Petzold 1972 measured of three waters, their particles' mean (Mobley 1994, table 3.10).
PhaseFunction petzold();

/// Of the lamp's light, in one of these ways.
PhaseFunction lampPhase(const SealedCase& sealed, double stamp_s);

}  // namespace fathom::sealed
