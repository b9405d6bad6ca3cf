#pragma once

#include "core/kinematics.h"
#include "effects/registry.h"
#include "sensors/vehicle.h"

/// The forward model of every navigation sensor: true state -> what the sensor would read, the nominal
/// equation first, then the effects that are on. The simulator runs it with double, the filter with
/// ceres::Jet; nobody else has an equation of a sensor.
///
/// All take the state at the time the reading was valid, which is its stamp + validityOffset(), and its stamp
/// t_s, in seconds from the recording's first entry: effects can be on for an interval. The camera's is in
/// camera_geometry.h.
namespace fathom {

/// Where a sensor truly sits: its nominal mounting with what effects make of it.
template <Sensor S, class T>
Mounting<T, S> sensorMounting(const Pose& T_robot_sensor, const EffectParameters<T>& effects, double t_s) {
  Mounting<T, S> m{T_robot_sensor.rotation.cast<T>(), T_robot_sensor.position.cast<T>()};
  applyEffects(effects, t_s, m);
  return m;
}

/// When a sensor's reading was valid, seconds after its stamp (negative: before).
template <Sensor S, class T>
T validityOffset(const EffectParameters<T>& effects, double t_s) {
  ValidityOffset<T, S> offset;
  applyEffects(effects, t_s, offset);
  return offset.seconds;
}

/// Gyro, rad/s, INS frame: the body rate in sensor axes. (The Earth's own rate is left out: effect
/// earth-rotation.)
template <class T>
Vector3<T> predictGyro(const KinematicState<T>& state, const Pose& T_robot_ins,
                       const EffectParameters<T>& effects, double t_s) {
  const auto mount = sensorMounting<Sensor::ins>(T_robot_ins, effects, t_s);
  GyroReading<T> reading{mount.R_robot_sensor.transpose() * state.angular_velocity_robot,
                         state.R_odom_robot * mount.R_robot_sensor};
  applyEffects(effects, t_s, reading);
  return reading.angular_velocity_ins;
}

/// Accelerometer, m/s², INS frame: specific force at the sensor,
/// f = R_ins_robot (a + alpha x l + omega x (omega x l) - R_robot_odom g)   (Farrell 2008, eq. 11.31 and
/// rigid body).
template <class T>
Vector3<T> predictSpecificForce(const KinematicState<T>& state, const World<T>& world,
                                const Pose& T_robot_ins, const EffectParameters<T>& effects, double t_s) {
  const auto mount = sensorMounting<Sensor::ins>(T_robot_ins, effects, t_s);
  const Vector3<T>& lever = mount.position_robot;
  const Vector3<T>& rate = state.angular_velocity_robot;
  const Vector3<T> gravity_robot = state.R_odom_robot.transpose() * world.gravity_odom.template cast<T>();
  const Vector3<T> at_sensor = state.acceleration_robot + state.angular_acceleration_robot.cross(lever) +
                               rate.cross(rate.cross(lever));
  AccelerometerReading<T> reading{mount.R_robot_sensor.transpose() * (at_sensor - gravity_robot)};
  applyEffects(effects, t_s, reading);
  return reading.specific_force_ins;
}

/// Attitude of the INS, R_odom_ins.
template <class T>
Matrix3<T> predictAttitude(const KinematicState<T>& state, const Pose& T_robot_ins,
                           const EffectParameters<T>& effects, double t_s) {
  return state.R_odom_robot * sensorMounting<Sensor::ins>(T_robot_ins, effects, t_s).R_robot_sensor;
}

/// DVL, m/s, DVL frame: velocity over ground at the sensor, R_dvl_robot (v + omega x l).
template <class T>
Vector3<T> predictDvlVelocity(const KinematicState<T>& state, const Pose& T_robot_dvl,
                              const EffectParameters<T>& effects, double t_s) {
  const auto mount = sensorMounting<Sensor::dvl>(T_robot_dvl, effects, t_s);
  const Vector3<T> at_sensor =
      state.velocity_robot + state.angular_velocity_robot.cross(mount.position_robot);
  DvlVelocity<T> reading{mount.R_robot_sensor.transpose() * at_sensor,
                         state.R_odom_robot * mount.R_robot_sensor};
  applyEffects(effects, t_s, reading);
  return reading.velocity_dvl;
}

/// Slant range of one DVL beam to the flat sea floor, m. Not finite or negative where the beam looks up or
/// along. Beams hang on the DVL: its misalignment and lever arm move them too.
template <class T>
T predictBeamRange(const KinematicState<T>& state, const World<T>& world, const Pose& T_robot_dvl,
                   const Pose& T_robot_beam, const EffectParameters<T>& effects, double t_s) {
  const auto mount = sensorMounting<Sensor::dvl>(T_robot_dvl, effects, t_s);
  const Pose T_dvl_beam = T_robot_dvl.inverse() * T_robot_beam;
  const Vector3<T> origin_robot =
      mount.position_robot + mount.R_robot_sensor * T_dvl_beam.position.template cast<T>();
  const Vector3<T> along_robot = mount.R_robot_sensor * T_dvl_beam.rotation.col(0).template cast<T>();
  const T height =
      state.position_odom.z() + state.R_odom_robot.row(2).dot(origin_robot) - world.sea_floor_z_m;
  return height / -state.R_odom_robot.row(2).dot(along_robot);
}

/// Absolute pressure at the depth sensor, Pa: p = p_air - rho g z, with odom's z = 0 at the surface
/// (hydrostatics, constant density).
template <class T>
T predictPressure(const KinematicState<T>& state, const World<T>& world, const DepthSheet& sheet,
                  const Pose& T_robot_depth, const EffectParameters<T>& effects, double t_s) {
  const auto mount = sensorMounting<Sensor::depth>(T_robot_depth, effects, t_s);
  const T z = state.position_odom.z() + state.R_odom_robot.row(2).dot(mount.position_robot);
  SeaWater<T> water{T(sheet.water_density_kg_m3)};
  applyEffects(effects, t_s, water);
  const T weight_n_m3 = water.density_kg_m3 * -world.gravity_odom.z();
  PressureReading<T> reading{T(sheet.atmospheric_pressure_pa) - weight_n_m3 * z};
  applyEffects(effects, t_s, reading);
  return reading.pressure_pa;
}

/// Position of a transponder, odom, m.
template <class T>
Vector3<T> predictUsbl(const KinematicState<T>& state, const Pose& T_robot_usbl) {
  return state.position_odom + state.R_odom_robot * T_robot_usbl.position.template cast<T>();
}

}  // namespace fathom
