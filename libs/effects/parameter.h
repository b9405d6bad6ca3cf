#pragma once

#include <string_view>

namespace fathom {

/// One named parameter of an effect, a scalar or a list of three. Neutral is always zero: at zero the effect
/// changes nothing, so every effect's size is also its distance from "not there".
struct Parameter {
  std::string_view name;   ///< with the unit as suffix, e.g. "offset_m"
  std::string_view unit;   ///< "1", "m", "deg", "s", …
  int size = 1;            ///< 1, or 3 for x y z
  double prior_sigma = 0;  ///< how large an engineer would expect it, same unit: keeps near-aliases apart
  double limit = 0;        ///< |value| beyond this is a mistake in a calibration file, same unit
};

}  // namespace fathom
