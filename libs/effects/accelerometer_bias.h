#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The accelerometer reads a specific force that is not there.
///   force_read = force_true + bias_m_s2
/// Parameter: bias_m_s2, INS frame, usually 1e-3 to 0.1. The simulator draws it from the data sheet's sigma,
/// the filter can carry it as a state. Source: additive bias model, Farrell 2008, ch. 11. Confused with: a
/// tilt of the INS (level, x and y: 9.8 mm/s² a milliradian); ins-misalignment.
struct AccelerometerBias {
  template <class T>
  using Stage = AccelerometerReading<T>;
  static constexpr std::string_view id = "accelerometer-bias";
  static constexpr std::array<Parameter, 1> parameters{{{"bias_m_s2", "m/s^2", 3, 0.02, 5.0}}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.specific_force_ins += Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
