#include "localization/error_state_filter.h"

namespace fathom {
namespace {

/// The blocks of the transition Jacobian that are neither zero nor identity.
struct TransitionBlocks {
  Matrix3d back;                  ///< Exp(omega dt)^T: orientation, velocity
  Matrix3d position_orientation;  ///< -R [v dt + a dt²/2]x
  Matrix3d rate_to_angle;         ///< Jr(omega dt) dt
  Matrix3d rate_to_velocity;      ///< [v']x Jr(omega dt) dt
};

TransitionBlocks transitionBlocks(const KinematicState<double>& m, double dt) {
  const Vector3d turn = m.angular_velocity_robot * dt;
  const Vector3d way = m.velocity_robot * dt + m.acceleration_robot * (0.5 * dt * dt);
  TransitionBlocks b;
  b.back = expSO3<double>(-turn);
  b.position_orientation = -m.R_odom_robot * crossMatrix<double>(way);
  b.rate_to_angle = rightJacobianSO3<double>(turn) * dt;
  b.rate_to_velocity =
      crossMatrix<double>(b.back * (m.velocity_robot + m.acceleration_robot * dt)) * b.rate_to_angle;
  return b;
}

}  // namespace

template <int N>
auto ErrorStateFilter<N>::noiseDensity(const ProcessNoise& noise) -> Vector {
  Vector q = Vector::Zero();
  q.template segment<3>(kPosition) = noise.position;
  q.template segment<3>(kOrientation) = noise.orientation;
  q.template segment<3>(kVelocity) = noise.velocity;
  q.template segment<3>(kAngularVelocity) = noise.angular_velocity;
  q.template segment<3>(kAcceleration) = noise.acceleration;
  if constexpr (N == kFullSize) {
    // A first-order Gauss-Markov process of variance s² and time constant tau is driven by density 2 s²/tau.
    const double k = 2.0 / noise.bias_time_constant_s;
    q.template segment<3>(kGyroBias) = k * noise.gyro_bias_sigma_rad_s.cwiseAbs2();
    q.template segment<3>(kAccelerometerBias) = k * noise.accelerometer_bias_sigma_m_s2.cwiseAbs2();
    q[kSeaFloor] = noise.sea_floor;
  }
  return q;
}

template <int N>
void ErrorStateFilter<N>::move(NavigationState<double>& x, double dt, const ProcessNoise& noise) {
  KinematicState<double>& m = x.motion;
  const Matrix3d turn = expSO3<double>(m.angular_velocity_robot * dt);
  m.position_odom += m.R_odom_robot * (m.velocity_robot * dt + m.acceleration_robot * (0.5 * dt * dt));
  m.velocity_robot = turn.transpose() * (m.velocity_robot + m.acceleration_robot * dt);
  m.R_odom_robot = m.R_odom_robot * turn;
  if constexpr (N == kFullSize) {
    const double decay = std::exp(-dt / noise.bias_time_constant_s);
    x.gyro_bias_rad_s *= decay;
    x.accelerometer_bias_m_s2 *= decay;
  }
}

template <int N>
auto ErrorStateFilter<N>::transition(const NavigationState<double>& x, double dt, const ProcessNoise& noise)
    -> Matrix {
  const TransitionBlocks b = transitionBlocks(x.motion, dt);
  const Matrix3d& R = x.motion.R_odom_robot;
  Matrix F = Matrix::Identity();
  F.template block<3, 3>(kPosition, kOrientation) = b.position_orientation;
  F.template block<3, 3>(kPosition, kVelocity) = R * dt;
  F.template block<3, 3>(kPosition, kAcceleration) = R * (0.5 * dt * dt);
  F.template block<3, 3>(kOrientation, kOrientation) = b.back;
  F.template block<3, 3>(kOrientation, kAngularVelocity) = b.rate_to_angle;
  F.template block<3, 3>(kVelocity, kVelocity) = b.back;
  F.template block<3, 3>(kVelocity, kAngularVelocity) = b.rate_to_velocity;
  F.template block<3, 3>(kVelocity, kAcceleration) = b.back * dt;
  if constexpr (N == kFullSize)
    F.template block<6, 6>(kGyroBias, kGyroBias) *= std::exp(-dt / noise.bias_time_constant_s);
  return F;
}

/// One step by the blocks of F: about a tenth of the dense product's work.
template <int N>
void ErrorStateFilter<N>::step(double dt, const ProcessNoise& noise) {
  const TransitionBlocks b = transitionBlocks(x.motion, dt);
  const Matrix3d& R = x.motion.R_odom_robot;
  const Vector half_noise = (0.5 * dt) * noiseDensity(noise);
  P.diagonal() += half_noise;

  // Columns of P F^T. Bias, offset and sea-floor columns only decay or stay.
  const auto columns = [this](int first) { return P.template middleCols<3>(first); };
  using Columns3 = Eigen::Matrix<double, N, 3>;
  const Columns3 to_position =
      columns(kPosition) + columns(kOrientation) * b.position_orientation.transpose() +
      (columns(kVelocity) * dt + columns(kAcceleration) * (0.5 * dt * dt)) * R.transpose();
  const Columns3 to_velocity = (columns(kVelocity) + columns(kAcceleration) * dt) * b.back.transpose() +
                               columns(kAngularVelocity) * b.rate_to_velocity.transpose();
  const Columns3 to_orientation =
      columns(kOrientation) * b.back.transpose() + columns(kAngularVelocity) * b.rate_to_angle.transpose();
  P.template middleCols<3>(kPosition) = to_position;
  P.template middleCols<3>(kOrientation) = to_orientation;
  P.template middleCols<3>(kVelocity) = to_velocity;
  double decay = 1.0;
  if constexpr (N == kFullSize) {
    decay = std::exp(-dt / noise.bias_time_constant_s);
    P.template middleCols<6>(kGyroBias) *= decay;
  }

  // Rows of F (P F^T): only the nine that move, then mirrored.
  const auto rows = [this](int first) { return P.template middleRows<3>(first).template leftCols<9>(); };
  using Rows9 = Eigen::Matrix<double, 3, 9>;
  const Rows9 position = rows(kPosition) + b.position_orientation * rows(kOrientation) +
                         R * (rows(kVelocity) * dt + rows(kAcceleration) * (0.5 * dt * dt));
  const Rows9 orientation = b.back * rows(kOrientation) + b.rate_to_angle * rows(kAngularVelocity);
  const Rows9 velocity =
      b.back * (rows(kVelocity) + rows(kAcceleration) * dt) + b.rate_to_velocity * rows(kAngularVelocity);
  P.template block<3, 9>(kPosition, 0) = position;
  P.template block<3, 9>(kOrientation, 0) = orientation;
  P.template block<3, 9>(kVelocity, 0) = velocity;
  if constexpr (N == kFullSize) P.template block<6, N>(kGyroBias, 0) *= decay;
  P.template topRightCorner<9, N - 9>() = P.template bottomLeftCorner<N - 9, 9>().transpose();
  P.template topLeftCorner<9, 9>() =
      (0.5 * (P.template topLeftCorner<9, 9>() + P.template topLeftCorner<9, 9>().transpose())).eval();

  P.diagonal() += half_noise;
  move(x, dt, noise);
}

template <int N>
void ErrorStateFilter<N>::predict(double dt_s, const ProcessNoise& noise) {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / kMaximumStep_s - 1e-9)));
  for (int k = 0; k < steps; ++k) step(dt_s / steps, noise);
}

template class ErrorStateFilter<kCoreSize>;
template class ErrorStateFilter<kFullSize>;

}  // namespace fathom
