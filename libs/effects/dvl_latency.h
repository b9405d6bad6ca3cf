#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The DVL's time stamp is not the time its readings were valid.
///   time of validity = time stamp - latency_s
/// of the velocity and of the beams' ranges alike: one ping gives both.
/// Parameter: latency_s = stamp - true time, usually 0 to 0.5 s (ping travel, averaging, serial line).
/// Source: definition.
/// Confused with: dvl-lever-arm (turn rate), accelerometer-bias; invisible at constant velocity.
struct DvlLatency {
  template <class T>
  using Stage = ValidityOffset<T, Sensor::dvl>;
  static constexpr std::string_view id = "dvl-latency";
  static constexpr std::array<Parameter, 1> parameters{{{"latency_s", "s", 1, 0.1, 5.0}}};
  template <class T>
  static void apply(const T* p, Stage<T>& offset) {
    offset.seconds -= p[0];
  }
};

}  // namespace fathom
