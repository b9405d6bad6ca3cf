#pragma once

#include <array>

#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

/// The DVL sits elsewhere than the drawing says.
///   position_robot,true = position_robot,nominal + offset_m, seen as velocity omega x offset
/// Parameter: offset_m = true - nominal mounting, robot frame, usually within 0.3 m.
/// Source: rigid-body kinematics, v_dvl = v + omega x l.
/// Confused with: dvl-latency while the turn rate is constant; invisible without turning.
struct DvlLeverArm {
  template <class T>
  using Stage = Mounting<T, Sensor::dvl>;
  static constexpr std::string_view id = "dvl-lever-arm";
  static constexpr std::array<Parameter, 1> parameters{{{"offset_m", "m", 3, 0.1, 20.0}}};
  template <class T>
  static void apply(const T* p, Stage<T>& mounting) {
    mounting.position_robot += Vector3<T>(p[0], p[1], p[2]);
  }
};

}  // namespace fathom
