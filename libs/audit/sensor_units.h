#pragma once

#include <array>
#include <numbers>

#include "core/kinematics.h"

namespace fathom {

/// A unit that a sensor's entries are in by mistake.
struct SensorUnit {
  const char* name;  ///< of the finding and its correction
  const char* says;
  double si;           ///< of one
  double unusual = 5;  ///< as DriverFault's
};

inline constexpr std::array kForceUnits{
    SensorUnit{"accelerometer-in-g", "it is in g", kStandardGravity_m_s2},
    SensorUnit{"accelerometer-in-milli-g", "it is in thousandths of g", kStandardGravity_m_s2 / 1000},
    SensorUnit{"accelerometer-in-cm-s2", "it is in cm/s²", 0.01},
    SensorUnit{"accelerometer-in-ft-s2", "it is in ft/s²", 0.3048}};

inline constexpr std::array kRateUnits{
    SensorUnit{"gyro-in-degrees", "it is in degrees a second", std::numbers::pi / 180},
    SensorUnit{"gyro-in-milliradians", "it is in thousandths of radians a second", 1e-3, 6},
    SensorUnit{"gyro-in-millidegrees", "it is in thousandths of degrees a second",
               1e-3 * std::numbers::pi / 180, 6.5},
    SensorUnit{"gyro-in-centidegrees", "it is in hundredths of degrees a second",
               1e-2 * std::numbers::pi / 180, 6.5},
    SensorUnit{"gyro-converted-twice", "it was taken for degrees a second, which it was not",
               180 / std::numbers::pi, 5.5},
    SensorUnit{"gyro-in-rpm", "it is in turns a minute", std::numbers::pi / 30, 6}};

inline constexpr std::array kVelocityUnits{SensorUnit{"dvl-in-millimetres", "it is in mm/s", 1e-3},
                                           SensorUnit{"dvl-in-centimetres", "it is in cm/s", 1e-2},
                                           SensorUnit{"dvl-in-knots", "it is in knots", 1852.0 / 3600},
                                           SensorUnit{"dvl-in-feet", "it is in feet a second", 0.3048},
                                           SensorUnit{"dvl-in-km-h", "it is in km/h", 1 / 3.6},
                                           SensorUnit{"dvl-in-mph", "it is in miles an hour", 0.44704}};

}  // namespace fathom
