#pragma once

#include <array>

#include "core/kinematics.h"

namespace fathom {

/// A unit that a sensor's entries are in by mistake.
struct SensorUnit {
  const char* name;  ///< of the finding and its correction
  const char* says;
  double si;  ///< of one
};

inline constexpr std::array kForceUnits{
    SensorUnit{"accelerometer-in-g", "it is in g", kStandardGravity_m_s2},
    SensorUnit{"accelerometer-in-milli-g", "it is in thousandths of g", kStandardGravity_m_s2 / 1000},
    SensorUnit{"accelerometer-in-cm-s2", "it is in cm/s²", 0.01}};

inline constexpr std::array kVelocityUnits{SensorUnit{"dvl-in-millimetres", "it is in mm/s", 1e-3},
                                           SensorUnit{"dvl-in-centimetres", "it is in cm/s", 1e-2}};

}  // namespace fathom
