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

/// x [+] delta, with the Exp of its orientation. N is 15 or 23; further blocks are left alone.
template <int N>
void retract(NavigationState<double>& x, const Eigen::Matrix<double, N, 1>& delta, const Matrix3d& rotation) {
  x.motion.position_odom += delta.template segment<3>(kPosition);
  x.motion.R_odom_robot = x.motion.R_odom_robot * rotation;
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

/// x [+] delta.
template <int N>
void retract(NavigationState<double>& x, const Eigen::Matrix<double, N, 1>& delta) {
  retract<N>(x, delta, expSO3<double>(delta.template segment<3>(kOrientation)));
}

/// The rotation vector that turns b's attitude into a's: Log(R_b^T R_a).
inline Vector3d attitudeDifference(const NavigationState<double>& a, const NavigationState<double>& b) {
  return logSO3<double>(b.motion.R_odom_robot.transpose() * a.motion.R_odom_robot);
}

/// a [-] b but for the orientation, which is left zero.
template <int N>
Eigen::Matrix<double, N, 1> vectorDifference(const NavigationState<double>& a,
                                             const NavigationState<double>& b) {
  Eigen::Matrix<double, N, 1> delta;
  delta.template segment<3>(kPosition) = a.motion.position_odom - b.motion.position_odom;
  delta.template segment<3>(kOrientation).setZero();
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

/// a [-] b: the delta for which b [+] delta = a.
template <int N>
Eigen::Matrix<double, N, 1> difference(const NavigationState<double>& a, const NavigationState<double>& b) {
  Eigen::Matrix<double, N, 1> delta = vectorDifference<N>(a, b);
  delta.template segment<3>(kOrientation) = attitudeDifference(a, b);
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

/// The motion's k-th derivatives become those by an error coordinate of it, at zero error, times `factor`.
template <int Size>
void seed(KinematicState<ceres::Jet<double, Size>>& motion, const Matrix3d& R_odom_robot, int column, int k,
          double factor = 1.0) {
  const int axis = column % 3;
  if (column / 3 * 3 == kOrientation) {
    // R [e]x for the axis's unit vector e.
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      motion.R_odom_robot(i, next).v[k] = factor * R_odom_robot(i, last);
      motion.R_odom_robot(i, last).v[k] = -factor * R_odom_robot(i, next);
    }
  } else {
    const std::array vectors{&motion.position_odom, &motion.position_odom, &motion.velocity_robot,
                             &motion.angular_velocity_robot,
                             &motion.acceleration_robot};  // by block; the orientation is dealt with above
    (*vectors[static_cast<std::size_t>(column / 3)])[axis].v[k] = factor;
  }
}

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
    const int column = columns.list[static_cast<std::size_t>(k)];
    if (column < kCoreSize)
      seed(y.motion, x.motion.R_odom_robot, column, k);
    else if (column < kAccelerometerBias)
      y.gyro_bias_rad_s[column - kGyroBias].v[k] = 1.0;
    else if (column < kPressureOffset)
      y.accelerometer_bias_m_s2[column - kAccelerometerBias].v[k] = 1.0;
    else
      (column == kPressureOffset ? y.pressure_offset_pa : y.sea_floor_z_m).v[k] = 1.0;
  }
  return y;
}

/// Adds the filter's bias states where they act: a bias is the effect of its name, whether it was calibrated,
/// simulated or is being estimated. They are of the first instance of an instrument.
template <class T>
void addBiases(const NavigationState<double>& x, EffectParameters<T>& effects) {
  const Vector3d &gyro = x.gyro_bias_rad_s, &accelerometer = x.accelerometer_bias_m_s2;
  effects.template add<GyroBias>({T(gyro[0]), T(gyro[1]), T(gyro[2])});
  effects.template add<AccelerometerBias>({T(accelerometer[0]), T(accelerometer[1]), T(accelerometer[2])});
  effects.template add<PressureOffset>({T(x.pressure_offset_pa)});
}

/// The calibration's effects at one time on one instance of an instrument, and the bias states.
inline EffectParameters<double> effectsOf(const NavigationState<double>& x,
                                          const EffectParameters<double>& calibration, double t_s,
                                          const Instance& instance) {
  auto effects = calibration.at<double>(t_s, instance);
  if (instance.isFirst()) addBiases(x, effects);
  return effects;
}

}  // namespace fathom
