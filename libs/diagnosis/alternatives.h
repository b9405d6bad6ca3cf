#pragma once

#include <optional>

#include "diagnosis/fits.h"
#include "diagnosis/result.h"

namespace fathom {

/// What else could stand in an effect's place.
struct InItsPlace {
  /// A fit with another effect there, as the last one, that is better. The rest is left then.
  std::optional<Refit> better;
  std::optional<Alternatives> set;  ///< with those that are as good, where there are
  double odds = 1;                  ///< of it and of all others there, against it
};

/// Of one of a fit's effects; tries the nearest few in full.
InItsPlace othersInPlaceOf(std::size_t effect, const Refit& fit, Fits& fits, const LeftOut& left_out);

/// Of the set of a fit's effect: whether one of the others is the same all over the recording. The right one
/// may be another than the one stated.
bool isAnotherSameEverywhere(const Alternatives& set, std::size_t effect, const Refit& fit, Fits& fits);

}  // namespace fathom
