#pragma once

#include <span>

#include "sensors/vehicle.h"

namespace fathom {

/// What an instrument's pressure sensor reads so far below the surface, Pa; and the inverse, m.
double pressureAt(double depth_m, const Vehicle& vehicle, const Instance& instance);
double depthOf(double pressure_pa, const Vehicle& vehicle, const Instance& instance);

/// What is written where an absolute pressure in Pa should be.
struct PressureUnit {
  const char* name;  ///< of the finding and its correction
  const char* says;
  double pa;  ///< of one; 0: metres of water
  enum class From {
    vacuum,
    air,     ///< the air's pressure is taken out
    surface  ///< metres: of depth where `sign` is 1, of height where it is -1
  } from = From::vacuum;
  double sign = 1;
};
/// The more usual first.
std::span<const PressureUnit> pressureUnits();
/// Absolute pressure, Pa.
double inPascal(double reading, const PressureUnit& unit, const Vehicle& vehicle, const Instance& instance);
/// How much the absolute pressure changes with the reading, Pa.
double pascalsEach(const PressureUnit& unit, const Vehicle& vehicle, const Instance& instance);

}  // namespace fathom
