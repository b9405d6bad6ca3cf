#pragma once

#include <Eigen/Cholesky>

#include "localization/navigation_state.h"

namespace fathom {

/// Continuous white noise that drives each block of the state: power spectral density per axis, block unit²
/// per second (variance gained in one second).
struct ProcessNoise {
  Vector3d position = Vector3d::Zero();                  ///< m²/s
  Vector3d orientation = Vector3d::Zero();               ///< rad²/s
  Vector3d velocity = Vector3d::Zero();                  ///< (m/s)²/s
  Vector3d angular_velocity = Vector3d::Constant(1e-2);  ///< (rad/s)²/s: how abruptly the vehicle turns
  Vector3d acceleration = Vector3d::Constant(1e-1);      ///< (m/s²)²/s: how abruptly it pushes
  double sea_floor = 2.5e-3;                             ///< m²/s: slope of the ground under way
  Vector3d gyro_bias_sigma_rad_s = Vector3d::Zero();     ///< stationary sigma of the bias process
  Vector3d accelerometer_bias_sigma_m_s2 = Vector3d::Zero();
  double bias_time_constant_s = 120.0;
};

/// The largest step predict() takes at once; longer ones are split (its noise integral is second order).
inline constexpr double kMaximumStep_s = 0.05;

/// An error-state extended Kalman filter on R^3 x SO(3) x R^(N-6); N is 15 or 23 (see navigation_state.h).
/// It knows motion and algebra, no sensor: measurements.h turns readings into residuals.
///
/// Motion over dt, angular velocity and acceleration (robot axes) held, integrated exactly in SO(3):
///   R' = R Exp(omega dt),  v' = Exp(omega dt)^T (v + a dt)  (so dv/dt = a - omega x v),  p' = p + R (v dt +
///   a dt²/2) bias' = exp(-dt/tau) bias; the rest stays.
/// Covariance: P' = F (P + Q dt/2) F^T + Q dt/2, the trapezoidal rule for the noise integral, which carries
/// the correlation of a driven block with what it drives.
template <int N>
class ErrorStateFilter {
 public:
  static_assert(N == kCoreSize || N == kFullSize);
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  NavigationState<double> x;
  Matrix P = Matrix::Identity();

  void predict(double dt_s, const ProcessNoise& noise);

  /// Dense transition Jacobian of one predict step of at most kMaximumStep_s: for the smoother and tests.
  static Matrix transition(const NavigationState<double>& x, double dt_s, const ProcessNoise& noise);
  /// The motion alone.
  static void move(NavigationState<double>& x, double dt_s, const ProcessNoise& noise);
  /// Diagonal of the noise density per second.
  static Vector noiseDensity(const ProcessNoise& noise);

  /// A linearized measurement: residual r = z - h(x), r ~ H error + v, v ~ N(0, R); H against the listed
  /// columns.
  template <int M, class Cols>
  struct Measurement {
    Eigen::Matrix<double, M, 1> residual;
    Eigen::Matrix<double, M, Cols::size> H;
    Eigen::Matrix<double, M, M> R;
  };

  /// Normalized innovation squared r^T S^-1 r. Fuses when it is at most `gate`.
  /// Joseph form (Bucy & Joseph 1968), expanded as P' = A + (K R - A H^T) K^T with A = P - K (P H^T)^T: the
  /// same stabilized result in O(N² M), symmetric to the last bit.
  template <int M, class Cols>
  double update(const Measurement<M, Cols>& m, double gate = std::numeric_limits<double>::infinity());

 private:
  void step(double dt_s, const ProcessNoise& noise);
};

// ---------------------------------------------------------------------------------------------------------------

template <int N>
template <int M, class Cols>
double ErrorStateFilter<N>::update(const Measurement<M, Cols>& m, double gate) {
  constexpr int K = Cols::size;
  Eigen::Matrix<double, N, K> P_columns;
  for (int k = 0; k < K; ++k) P_columns.col(k) = P.col(Cols::list[static_cast<std::size_t>(k)]);
  const Eigen::Matrix<double, N, M> PHt = P_columns * m.H.transpose();
  Eigen::Matrix<double, K, M> PHt_rows;
  for (int k = 0; k < K; ++k) PHt_rows.row(k) = PHt.row(Cols::list[static_cast<std::size_t>(k)]);
  const Eigen::Matrix<double, M, M> S = m.H * PHt_rows + m.R;

  const Eigen::LLT<Eigen::Matrix<double, M, M>> llt(S);
  const double nis = m.residual.dot(llt.solve(m.residual));
  if (llt.info() != Eigen::Success || !(nis <= gate)) return nis;

  const Eigen::Matrix<double, N, M> gain = llt.solve(PHt.transpose()).transpose();
  P.noalias() -= gain * PHt.transpose();
  Eigen::Matrix<double, N, M> correction = gain * m.R;
  for (int k = 0; k < K; ++k)
    correction.noalias() -= P.col(Cols::list[static_cast<std::size_t>(k)]) * m.H.col(k).transpose();
  P.noalias() += correction * gain.transpose();

  const Vector delta = gain * m.residual;
  retract<N>(x, delta);
  // The error is from now on measured in the tangent space at the corrected attitude (Sola 2017, eq. 287).
  const Matrix3d reset = rightJacobianSO3<double>(delta.template segment<3>(kOrientation));
  P.template middleCols<3>(kOrientation) =
      (P.template middleCols<3>(kOrientation) * reset.transpose()).eval();
  P.template middleRows<3>(kOrientation) = (reset * P.template middleRows<3>(kOrientation)).eval();
  P = (0.5 * (P + P.transpose())).eval();
  return nis;
}

extern template class ErrorStateFilter<kCoreSize>;
extern template class ErrorStateFilter<kFullSize>;

}  // namespace fathom
