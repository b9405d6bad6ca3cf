#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The pressure sensor's zero, or the day's air pressure, is not the vehicle file's.
///   pressure_read = pressure_true + offset_pa
/// Parameter: offset_pa, usually within 2000 Pa (weather), 100 Pa is 1 cm of water.
/// Source: additive bias model.
/// Confused with: an error of the vehicle's height in odom (identical without another height reference).
struct PressureOffset {
  template <class T>
  using Stage = PressureReading<T>;
  static constexpr std::string_view id = "pressure-offset";
  static constexpr std::array<Parameter, 1> parameters{{{"offset_pa", "Pa", 1, 1000.0, 1e6}}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.pressure_pa += p[0];
  }
};

}  // namespace fathom
