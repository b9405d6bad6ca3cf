#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <stdexcept>

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

/// The same, found at run time: at most as many as a measurement has derivatives.
struct StateColumns {
  static constexpr int kMost = 12;
  std::array<int, kMost> list{};
  int count = 0;

  /// Throws std::length_error where there are too many.
  void add(int column) {
    if (count == kMost) throw std::length_error("a measurement depends on too many states");
    list[static_cast<std::size_t>(count++)] = column;
  }
  /// Position of a state index in the list, or -1.
  int find(int index) const {
    const auto* const end = list.data() + count;
    const auto* const found = std::find(list.data(), end, index);
    return found == end ? -1 : static_cast<int>(found - list.data());
  }
};

/// The state with derivatives against the chosen error coordinates, at zero error: the k-th of a Jet's is by
/// the k-th column.
template <int Size>
NavigationState<ceres::Jet<double, Size>> lift(const NavigationState<double>& x,
                                               const StateColumns& columns) {
  using Jet = ceres::Jet<double, Size>;
  NavigationState<Jet> y;
  y.motion = {x.motion.position_odom.cast<Jet>(),      x.motion.R_odom_robot.cast<Jet>(),
              x.motion.velocity_robot.cast<Jet>(),     x.motion.angular_velocity_robot.cast<Jet>(),
              x.motion.acceleration_robot.cast<Jet>(), Vector3<Jet>::Zero()};
  y.gyro_bias_rad_s = x.gyro_bias_rad_s.cast<Jet>();
  y.accelerometer_bias_m_s2 = x.accelerometer_bias_m_s2.cast<Jet>();
  y.pressure_offset_pa = Jet(x.pressure_offset_pa);
  y.sea_floor_z_m = Jet(x.sea_floor_z_m);
  for (int k = 0; k < columns.count; ++k) {
    const int index = columns.list[static_cast<std::size_t>(k)], axis = index % 3;
    if (index == kPressureOffset) {
      y.pressure_offset_pa.v[k] = 1.0;
    } else if (index == kSeaFloor) {
      y.sea_floor_z_m.v[k] = 1.0;
    } else if (index / 3 * 3 == kOrientation) {
      const Matrix3d slope = x.motion.R_odom_robot * crossMatrix<double>(Vector3d::Unit(axis));
      for (int i = 0; i < 9; ++i) y.motion.R_odom_robot(i).v[k] = slope(i);
    } else {
      const std::array vectors{&y.motion.position_odom,      &y.motion.position_odom,
                               &y.motion.velocity_robot,     &y.motion.angular_velocity_robot,
                               &y.motion.acceleration_robot, &y.gyro_bias_rad_s,
                               &y.accelerometer_bias_m_s2};  // by block; the orientation is dealt with above
      (*vectors[static_cast<std::size_t>(index / 3)])[axis].v[k] = 1.0;
    }
  }
  return y;
}

/// The calibration's effects at one time on one instance of an instrument, with the filter's bias states
/// added where they act: a bias is the effect of its name, whether it was calibrated, simulated or is being
/// estimated. The states are of the first instance.
template <class T>
EffectParameters<T> effectsOf(const NavigationState<T>& x, const EffectParameters<double>& calibration,
                              double t_s, const Instance& instance) {
  auto effects = calibration.template at<T>(t_s, instance);
  if (!instance.isFirst()) return effects;
  effects.template add<GyroBias>({x.gyro_bias_rad_s[0], x.gyro_bias_rad_s[1], x.gyro_bias_rad_s[2]});
  effects.template add<AccelerometerBias>(
      {x.accelerometer_bias_m_s2[0], x.accelerometer_bias_m_s2[1], x.accelerometer_bias_m_s2[2]});
  effects.template add<PressureOffset>({x.pressure_offset_pa});
  return effects;
}

}  // namespace fathom
