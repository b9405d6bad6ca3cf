#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The DVL is mounted at another angle than the drawing says.
///   R_robot_dvl,true = R_robot_dvl,nominal Exp(r)
/// Parameter: rotation_deg = r, a rotation vector in the DVL's frame, usually within a few degrees about z.
/// Source: Kinsey & Whitcomb 2006 (in-situ alignment); observable with surge and sway and a position
/// reference (Pan & Wu 2015, arXiv 1509.02054). Confused with: a constant heading error (identical without an
/// outside position or heading reference); ins-misalignment.
struct DvlMisalignment {
  template <class T>
  using Stage = Mounting<T, Sensor::dvl>;
  static constexpr std::string_view id = "dvl-misalignment";
  static constexpr std::array<Parameter, 1> parameters{{{"rotation_deg", "deg", 3, 2.0, 180.0}}};
  template <class T>
  static void apply(const T* p, Stage<T>& mounting) {
    const Vector3<T> rotation(p[0], p[1], p[2]);
    mounting.R_robot_sensor = mounting.R_robot_sensor * expSO3<T>(rotation * T(radians(1.0)));
  }
};

}  // namespace fathom
