#pragma once

#include <array>
#include <string_view>

namespace fathom {

/// Kinds of sensors, as a recording labels their entries: what a parameter of ParameterKind::sensor names. It
/// holds the place in this list.
inline constexpr std::array<std::string_view, 8> kSensorKinds{"INS",     "DVL",  "DEPTH",     "USBL",
                                                              "COMPASS", "GNSS", "ALTIMETER", "CAMERA"};

/// The place of a label; -1: it is not listed.
constexpr int sensorKind(std::string_view label) {
  for (std::size_t i = 0; i < kSensorKinds.size(); ++i)
    if (kSensorKinds[i] == label) return static_cast<int>(i);
  return -1;
}

}  // namespace fathom
