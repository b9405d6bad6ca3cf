#pragma once

#include "core/kinematics.h"
#include "effects/registry.h"
#include "effects/sensor_kinds.h"

namespace fathom {

/// The camera, as effects name it (Mounting, ValidityOffset).
struct Camera {
  static constexpr const char* label = "CAMERA";
};

/// Before any effect, of a measurement stamped t_s after the recording's first entry.
template <class Instrument, class T>
ValidityOffset<T, Instrument> validAtStamp(double t_s) {
  constexpr int kSensor = sensorKind(Instrument::label);
  static_assert(kSensor >= 0, "name the instrument in effects/sensor_kinds.h");
  return {{T(0), t_s, kSensor}};
}

/// All that a sensor's equation may look at: the vehicle's motion at the time of validity, the world, the
/// effects that are on. SI units.
template <class T>
struct Inputs {
  KinematicState<T> state;
  World<T> world;
  EffectParameters<T> effects;
  double t_s = 0;  ///< stamp of the measurement, since the recording's first entry

  /// A stage of the forward model: what starts as `nominal`, with the effects that act there.
  template <class Stage>
  Stage at(Stage nominal) const {
    applyEffects(effects, t_s, nominal);
    return nominal;
  }

  /// Where an instrument truly sits.
  template <class Instrument>
  Mounting<T, Instrument> mounting(const Pose& T_robot_sensor) const {
    return at(Mounting<T, Instrument>{T_robot_sensor.rotation.cast<T>(), T_robot_sensor.position.cast<T>()});
  }

  /// When an instrument's measurement was valid, seconds after its stamp (negative: before). `state` is the
  /// motion at that time.
  template <class Instrument>
  T validityOffset() const {
    return at(validAtStamp<Instrument, T>(t_s)).seconds;
  }
};

/// From a place on the robot along a unit vector, both in its axes, to the flat sea floor, m. Not finite or
/// negative where that looks up or along.
template <class T>
T rangeToFloor(const Inputs<T>& in, const Vector3<T>& from_robot, const Vector3<T>& along_robot) {
  const T height =
      in.state.position_odom.z() + in.state.R_odom_robot.row(2).dot(from_robot) - in.world.sea_floor_z_m;
  return height / -in.state.R_odom_robot.row(2).dot(along_robot);
}

/// When a measurement was valid, and where its instrument sits, where there is nothing but effects.
template <class Instrument, class T>
T validityOffset(const EffectParameters<T>& effects, double t_s) {
  auto offset = validAtStamp<Instrument, T>(t_s);
  applyEffects(effects, t_s, offset);
  return offset.seconds;
}
template <class Instrument, class T>
Mounting<T, Instrument> mountingOf(const Pose& T_robot_sensor, const EffectParameters<T>& effects,
                                   double t_s) {
  Mounting<T, Instrument> m{T_robot_sensor.rotation.cast<T>(), T_robot_sensor.position.cast<T>()};
  applyEffects(effects, t_s, m);
  return m;
}

}  // namespace fathom
