#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The gyro reads a rate that is not there.
///   rate_read = rate_true + bias_rad_s
/// Parameter: bias_rad_s, INS frame; MEMS 1e-4 to 1e-2, fibre-optic below 1e-6 rad/s. The simulator draws it
/// from the data sheet's sigma, the filter can carry it as a state. Source: additive bias model, Farrell
/// 2008, ch. 11. Confused with: earth-rotation (7.3e-5 rad/s, constant in the world and not in the body).
struct GyroBias {
  template <class T>
  using Stage = GyroReading<T>;
  static constexpr std::string_view id = "gyro-bias";
  static constexpr std::array<Parameter, 1> parameters{{{"bias_rad_s", "rad/s", 3, 1e-3, 1.0}}};
  template <class T>
  static void apply(const T* p, Stage<T>& reading) {
    reading.angular_velocity_ins += Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
