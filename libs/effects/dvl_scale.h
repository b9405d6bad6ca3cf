#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The DVL assumes a sound speed that is not the water's (or has a transducer scale error).
///   velocity_read = velocity_true (1 + scale_error)
/// Parameter: scale_error = measured/true - 1, usually within +-0.02: v = v_used c/c_used, and c varies
/// by 1.3 m/s a degree Celsius near 10 degrees (Mackenzie 1981), 1.3 m/s a unit of salinity. Source: Kinsey &
/// Whitcomb 2006, sec. 3. A phased-array DVL is wrong in the vertical only. Confused with: water current
/// while the heading is constant; a wrong panel or marker size where distance comes from the DVL alone.
struct DvlScale {
  template <class T>
  using Stage = DvlVelocity<T>;
  static constexpr std::string_view id = "dvl-scale";
  static constexpr std::array<Parameter, 1> parameters{{{"scale_error", "1", 1, 0.02, 0.5}}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.velocity_dvl *= T(1.0) + p[0];
  }
};

}  // namespace fathom
