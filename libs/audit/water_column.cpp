#include "audit/water_column.h"

#include <array>

namespace fathom {
namespace {
using enum PressureUnit::From;

constexpr double kPsi_pa = 6894.757;  // pound-force (NIST SP 811) a square inch
constexpr std::array kUnits{
    PressureUnit{"pressure-in-kilopascal", "it is in kPa", 1000},
    PressureUnit{"pressure-in-millibar", "it is in mbar", 100},
    PressureUnit{"pressure-in-bar", "it is in bar", 1e5},
    PressureUnit{"pressure-in-decibar", "it is in dbar", 1e4},
    PressureUnit{"pressure-is-depth", "it is a depth in metres", 0, surface},
    PressureUnit{"pressure-gauge", "the air's is taken out of it", 1, air},
    PressureUnit{"pressure-in-kilopascal-gauge", "it is in kPa, and the air's is taken out", 1000, air},
    PressureUnit{"pressure-in-millibar-gauge", "it is in mbar, and the air's is taken out", 100, air},
    PressureUnit{"pressure-in-bar-gauge", "it is in bar, and the air's is taken out", 1e5, air},
    PressureUnit{"pressure-in-decibar-gauge", "it is in dbar, and the air's is taken out", 1e4, air},
    PressureUnit{"pressure-in-psi", "it is in psi", kPsi_pa},
    PressureUnit{"pressure-in-psi-gauge", "it is in psi, and the air's is taken out", kPsi_pa, air},
    PressureUnit{"pressure-is-height", "it is a height in metres, negative below the surface", 0, surface,
                 -1}};

}  // namespace

double pressureAt(double depth_m, const Vehicle& vehicle, const Instance& instance) {
  Inputs<double> there;
  there.world.gravity_odom = vehicle.gravityOdom();
  there.state.position_odom.z() = -depth_m;
  return Depth::pressure(there, sheetOf<Depth>(vehicle, instance), {});
}

double depthOf(double pressure_pa, const Vehicle& vehicle, const Instance& instance) {
  const double surface_pa = pressureAt(0, vehicle, instance);
  return (pressure_pa - surface_pa) / (pressureAt(1, vehicle, instance) - surface_pa);
}

std::span<const PressureUnit> pressureUnits() { return kUnits; }

double inPascal(double reading, const PressureUnit& unit, const Vehicle& vehicle, const Instance& instance) {
  if (unit.from == surface) return pressureAt(unit.sign * reading, vehicle, instance);
  return unit.pa * reading + (unit.from == air ? pressureAt(0, vehicle, instance) : 0);
}

double pascalsEach(const PressureUnit& unit, const Vehicle& vehicle, const Instance& instance) {
  return inPascal(1, unit, vehicle, instance) - inPascal(0, unit, vehicle, instance);
}

}  // namespace fathom
