#pragma once

#include "core/random.h"
#include "localization/navigation_state.h"
#include "support/random_pose.h"

namespace fathom::test {

/// A state anywhere a vehicle could be: any attitude, metres, metres a second, a radian a second.
inline NavigationState<double> randomState(Random& random) {
  NavigationState<double> x;
  x.motion.position_odom = 10.0 * random.normal3();
  x.motion.R_odom_robot = expSO3<double>(3.0 * random.normal3());
  x.motion.velocity_robot = random.normal3();
  x.motion.angular_velocity_robot = random.normal3();
  x.motion.acceleration_robot = random.normal3();
  x.gyro_bias_rad_s = 0.01 * random.normal3();
  x.accelerometer_bias_m_s2 = 0.1 * random.normal3();
  x.pressure_offset_pa = 1000.0 * random.normal();
  x.sea_floor_z_m = -20.0 + random.normal();
  return x;
}

/// A positive definite matrix with correlations.
template <int N>
Eigen::Matrix<double, N, N> randomCovariance(Random& random, double scale = 1.0) {
  Eigen::Matrix<double, N, N> A;
  for (int i = 0; i < N * N; ++i) A(i) = random.normal();
  return scale * (A * A.transpose() / N + 0.1 * Eigen::Matrix<double, N, N>::Identity());
}

}  // namespace fathom::test
