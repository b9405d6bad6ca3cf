#pragma once

#include "diagnosis/refit.h"

/// How large an effect has to be for its name to be said, in units of what the recording could resolve: noise
/// has tails, too, and what a panel and a lens do to light is known less well than that; what is on for a
/// part can be made to fit anything.
namespace fathom {

/// sqrt(lambda) from which on an effect is named.
double discoveryOf(const Candidate& effect);
/// The least of a fit's effects.
double discoveryOf(const Refit& fit);

/// Whether any of a fit's effects is on for good.
bool isLasting(const Refit& fit);

/// Whether what one fit has beside another is large enough for an effect to be named.
bool isLarge(const Refit& fit, const Refit& fewer, double discovery);
/// Whether anything that a fit has found is.
bool isLarge(const Refit& fit, const Refit& before);

}  // namespace fathom
