#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <array>

#include "core/kinematics.h"
#include "effects/registry.h"

/// The filter's state and its error coordinates.
///
/// The first 15 are the paper's (Mueller et al. 2018, sec. III-E): position, orientation, linear velocity,
/// angular velocity, linear acceleration. Eight more are optional: gyro and accelerometer bias, pressure
/// offset, height of the sea floor. The error state lives in the tangent space: R_true = R Exp(error) on
/// SO(3), plain differences elsewhere.
namespace fathom {

/// Where each block starts in the error state.
enum Index : int {
  kPosition = 0,            ///< odom, m
  kOrientation = 3,         ///< rotation vector in robot axes, rad
  kVelocity = 6,            ///< robot axes, m/s
  kAngularVelocity = 9,     ///< robot axes, rad/s
  kAcceleration = 12,       ///< robot axes, m/s², d²position/dt² without gravity
  kGyroBias = 15,           ///< INS axes, rad/s
  kAccelerometerBias = 18,  ///< INS axes, m/s²
  kPressureOffset = 21,     ///< Pa
  kSeaFloor = 22,           ///< odom z, m
};
inline constexpr int kCoreSize = 15;
inline constexpr int kFullSize = 23;

template <class T>
struct NavigationState {
  KinematicState<T> motion;
  Vector3<T> gyro_bias_rad_s = Vector3<T>::Zero();
  Vector3<T> accelerometer_bias_m_s2 = Vector3<T>::Zero();
  T pressure_offset_pa = T(0);
  T sea_floor_z_m = T(0);
};

/// x [+] delta. N is 15 or 23; further blocks are left alone.
template <int N>
void retract(NavigationState<double>& x, const Eigen::Matrix<double, N, 1>& delta) {
  x.motion.position_odom += delta.template segment<3>(kPosition);
  x.motion.R_odom_robot = x.motion.R_odom_robot * expSO3<double>(delta.template segment<3>(kOrientation));
  x.motion.velocity_robot += delta.template segment<3>(kVelocity);
  x.motion.angular_velocity_robot += delta.template segment<3>(kAngularVelocity);
  x.motion.acceleration_robot += delta.template segment<3>(kAcceleration);
  if constexpr (N == kFullSize) {
    x.gyro_bias_rad_s += delta.template segment<3>(kGyroBias);
    x.accelerometer_bias_m_s2 += delta.template segment<3>(kAccelerometerBias);
    x.pressure_offset_pa += delta[kPressureOffset];
    x.sea_floor_z_m += delta[kSeaFloor];
  }
}

/// a [-] b: the delta for which b [+] delta = a.
template <int N>
Eigen::Matrix<double, N, 1> difference(const NavigationState<double>& a, const NavigationState<double>& b) {
  Eigen::Matrix<double, N, 1> delta;
  delta.template segment<3>(kPosition) = a.motion.position_odom - b.motion.position_odom;
  delta.template segment<3>(kOrientation) =
      logSO3<double>(b.motion.R_odom_robot.transpose() * a.motion.R_odom_robot);
  delta.template segment<3>(kVelocity) = a.motion.velocity_robot - b.motion.velocity_robot;
  delta.template segment<3>(kAngularVelocity) =
      a.motion.angular_velocity_robot - b.motion.angular_velocity_robot;
  delta.template segment<3>(kAcceleration) = a.motion.acceleration_robot - b.motion.acceleration_robot;
  if constexpr (N == kFullSize) {
    delta.template segment<3>(kGyroBias) = a.gyro_bias_rad_s - b.gyro_bias_rad_s;
    delta.template segment<3>(kAccelerometerBias) = a.accelerometer_bias_m_s2 - b.accelerometer_bias_m_s2;
    delta[kPressureOffset] = a.pressure_offset_pa - b.pressure_offset_pa;
    delta[kSeaFloor] = a.sea_floor_z_m - b.sea_floor_z_m;
  }
  return delta;
}

/// A compile-time list of error-state columns that a measurement depends on.
template <int... I>
struct Columns {
  static constexpr int size = sizeof...(I);
  static constexpr std::array<int, sizeof...(I)> list{I...};
  /// Position of a state index in the list, or -1.
  static constexpr int find(int index) {
    for (int k = 0; k < size; ++k)
      if (list[static_cast<std::size_t>(k)] == index) return k;
    return -1;
  }
};

/// The state with derivatives against the chosen error coordinates, at zero error.
template <class Cols>
NavigationState<ceres::Jet<double, Cols::size>> lift(const NavigationState<double>& x) {
  using Jet = ceres::Jet<double, Cols::size>;
  const auto scalar = [](double value, int index) {
    Jet jet(value);
    if (const int k = Cols::find(index); k >= 0) jet.v[k] = 1.0;
    return jet;
  };
  const auto vector = [&](const Vector3d& v, int first) {
    return Vector3<Jet>(scalar(v.x(), first), scalar(v.y(), first + 1), scalar(v.z(), first + 2));
  };
  NavigationState<Jet> y;
  y.motion.position_odom = vector(x.motion.position_odom, kPosition);
  y.motion.velocity_robot = vector(x.motion.velocity_robot, kVelocity);
  y.motion.angular_velocity_robot = vector(x.motion.angular_velocity_robot, kAngularVelocity);
  y.motion.acceleration_robot = vector(x.motion.acceleration_robot, kAcceleration);
  y.motion.R_odom_robot = x.motion.R_odom_robot.cast<Jet>();
  for (int axis = 0; axis < 3; ++axis) {
    const int k = Cols::find(kOrientation + axis);
    if (k < 0) continue;
    const Matrix3d slope = x.motion.R_odom_robot * crossMatrix<double>(Vector3d::Unit(axis));
    for (int i = 0; i < 9; ++i) y.motion.R_odom_robot(i).v[k] = slope(i);
  }
  y.gyro_bias_rad_s = vector(x.gyro_bias_rad_s, kGyroBias);
  y.accelerometer_bias_m_s2 = vector(x.accelerometer_bias_m_s2, kAccelerometerBias);
  y.pressure_offset_pa = scalar(x.pressure_offset_pa, kPressureOffset);
  y.sea_floor_z_m = scalar(x.sea_floor_z_m, kSeaFloor);
  return y;
}

/// The calibration's effects at one time, with the filter's bias states added where they act: a bias is the
/// effect of its name, whether it was calibrated, simulated or is being estimated.
template <class T>
EffectParameters<T> effectsOf(const NavigationState<T>& x, const EffectParameters<double>& calibration,
                              double t_s) {
  auto effects = calibration.template at<T>(t_s);
  effects.template add<GyroBias>({x.gyro_bias_rad_s[0], x.gyro_bias_rad_s[1], x.gyro_bias_rad_s[2]});
  effects.template add<AccelerometerBias>(
      {x.accelerometer_bias_m_s2[0], x.accelerometer_bias_m_s2[1], x.accelerometer_bias_m_s2[2]});
  effects.template add<PressureOffset>({x.pressure_offset_pa});
  return effects;
}

}  // namespace fathom
