#pragma once

#include <array>
#include <string_view>

#include "core/kinematics.h"

namespace fathom {

/// What a vehicle does, as far as what drives its motion differs by it.
enum class Regime { station_keeping, transit, turning };
inline constexpr std::array kEveryRegime{Regime::station_keeping, Regime::transit, Regime::turning};
constexpr std::string_view nameOf(Regime regime) {
  return std::array<std::string_view, 3>{"station keeping", "transit",
                                         "turning"}[static_cast<std::size_t>(regime)];
}

/// Above these it travels, or turns (which comes first).
struct RegimeLimits {
  double transit_m_s = 0.3;
  double turning_rad_s = radians(6.0);

  Regime of(const KinematicState<double>& motion) const {
    if (motion.angular_velocity_robot.norm() > turning_rad_s) return Regime::turning;
    return motion.velocity_robot.norm() > transit_m_s ? Regime::transit : Regime::station_keeping;
  }
};

/// Densities of what drives the motion, each axis (see ProcessNoise).
struct DrivingNoise {
  Vector3d angular_velocity, acceleration;
};

}  // namespace fathom
