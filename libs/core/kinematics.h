#pragma once

#include "core/geometry.h"

namespace fathom {

/// The vehicle's motion at one instant: what a sensor's forward model may look at. SI units.
template <class T>
struct KinematicState {
  Vector3<T> position_odom = Vector3<T>::Zero();           ///< robot reference point
  Matrix3<T> R_odom_robot = Matrix3<T>::Identity();        ///< attitude
  Vector3<T> velocity_robot = Vector3<T>::Zero();          ///< over ground, in robot axes
  Vector3<T> angular_velocity_robot = Vector3<T>::Zero();  ///< of robot against odom, in robot axes
  Vector3<T> acceleration_robot = Vector3<T>::Zero();  ///< d²position/dt² in robot axes, without gravity
  Vector3<T> angular_acceleration_robot = Vector3<T>::Zero();  ///< zero where it is not known (the filter)
};

/// The motion a little later (negative: earlier), at constant acceleration and angular acceleration over
/// ground: what a sensor saw whose reading was valid then.
template <class T>
KinematicState<T> extrapolated(const KinematicState<T>& state, const T& seconds) {
  const Vector3<T> turned =
      state.angular_velocity_robot * seconds + state.angular_acceleration_robot * (0.5 * seconds * seconds);
  const Matrix3<T> R_robot_later = expSO3<T>(turned);
  const auto inLaterAxes = [&](const Vector3<T>& v) { return Vector3<T>(R_robot_later.transpose() * v); };
  KinematicState<T> later = state;
  later.position_odom += state.R_odom_robot * (state.velocity_robot * seconds +
                                               state.acceleration_robot * (0.5 * seconds * seconds));
  later.R_odom_robot = state.R_odom_robot * R_robot_later;
  later.velocity_robot = inLaterAxes(state.velocity_robot + state.acceleration_robot * seconds);
  later.acceleration_robot = inLaterAxes(state.acceleration_robot);
  later.angular_velocity_robot += state.angular_acceleration_robot * seconds;
  return later;
}

inline constexpr double kStandardGravity_m_s2 = 9.80665;  ///< where nothing better is known

/// What is true of the world around the vehicle.
template <class T>
struct World {
  Vector3d gravity_odom{0.0, 0.0, -kStandardGravity_m_s2};  ///< m/s²
  T sea_floor_z_m = T(0);  ///< height in odom of the flat floor under the vehicle
};

}  // namespace fathom
