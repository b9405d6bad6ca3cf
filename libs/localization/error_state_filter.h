#pragma once

#include <Eigen/Cholesky>
#include <limits>
#include <type_traits>

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
    using Columns = Cols;
    Eigen::Matrix<double, M, 1> residual;
    Eigen::Matrix<double, M, Cols::size> H;
    Eigen::Matrix<double, M, M> R;
  };
  /// The same where H is the identity: a reading of the error coordinates themselves.
  template <class Cols>
  struct Selection {
    using Columns = Cols;
    Eigen::Matrix<double, Cols::size, 1> residual;
    Eigen::Matrix<double, Cols::size, Cols::size> R;
  };

  /// Normalized innovation squared r^T S^-1 r. Fuses when it is at most `gate`.
  /// Joseph form (Bucy & Joseph 1968), expanded as P' = A - (A H^T - K R) K^T with A = P - K (P H^T)^T: the
  /// same stabilized result in O(N² M), symmetric to the last bit.
  template <class AnyMeasurement>
  double update(const AnyMeasurement& m, double gate = std::numeric_limits<double>::infinity());

 private:
  void step(double dt_s, const ProcessNoise& noise);
  void correct(const Vector& delta);
};

// ---------------------------------------------------------------------------------------------------------------

namespace detail {

// Products written as sums of columns: the compiler turns them into straight vector code, where Eigen would
// pack the matrices for its large-product kernel.

/// P H^T, for H against the listed columns.
template <class Cols, int N, int M>
Eigen::Matrix<double, N, M> timesTransposed(const Eigen::Matrix<double, N, N>& P,
                                            const Eigen::Matrix<double, M, Cols::size>& H) {
  Eigen::Matrix<double, N, M> product = P.col(Cols::list[0]) * H.col(0).transpose();
  for (int k = 1; k < Cols::size; ++k) {
    const auto column = P.col(Cols::list[static_cast<std::size_t>(k)]);
    for (int i = 0; i < M; ++i) product.col(i) += column * H(i, k);
  }
  return product;
}

/// P -= A B^T.
template <int N, int M>
void subtractOuter(Eigen::Matrix<double, N, N>& P, const Eigen::Matrix<double, N, M>& A,
                   const Eigen::Matrix<double, N, M>& B) {
  for (int j = 0; j < N; ++j) {
    Eigen::Matrix<double, N, 1> column = P.col(j);
    for (int i = 0; i < M; ++i) column -= A.col(i) * B(j, i);
    P.col(j) = column;
  }
}

/// X S^-1, in place, by the Cholesky factor of S: forward, then backward substitution over whole columns.
template <int N, int M>
void solveInPlace(const Eigen::Matrix<double, M, M>& L, Eigen::Matrix<double, N, M>& X) {
  const Eigen::Matrix<double, M, 1> reciprocal = L.diagonal().cwiseInverse();
  for (int j = 0; j < M; ++j) {
    for (int k = 0; k < j; ++k) X.col(j) -= X.col(k) * L(j, k);
    X.col(j) *= reciprocal[j];
  }
  for (int j = M - 1; j >= 0; --j) {
    for (int k = j + 1; k < M; ++k) X.col(j) -= X.col(k) * L(k, j);
    X.col(j) *= reciprocal[j];
  }
}

}  // namespace detail

template <int N>
template <class AnyMeasurement>
double ErrorStateFilter<N>::update(const AnyMeasurement& m, double gate) {
  using Cols = typename AnyMeasurement::Columns;
  constexpr int M = decltype(m.residual)::RowsAtCompileTime;
  constexpr bool kSelects = std::is_same_v<AnyMeasurement, Selection<Cols>>;
  const auto column = [](int k) { return Cols::list[static_cast<std::size_t>(k)]; };

  Eigen::Matrix<double, N, M> PHt;
  Eigen::Matrix<double, M, M> S = m.R;
  if constexpr (kSelects) {
    for (int k = 0; k < M; ++k) PHt.col(k) = P.col(column(k));
    for (int k = 0; k < M; ++k) S.row(k) += PHt.row(column(k));
  } else {
    PHt = detail::timesTransposed<Cols, N, M>(P, m.H);
    for (int k = 0; k < Cols::size; ++k)
      for (int i = 0; i < M; ++i) S.col(i) += m.H.col(k) * PHt(column(k), i);
  }

  const Eigen::LLT<Eigen::Matrix<double, M, M>> llt(S);
  const Eigen::Matrix<double, M, 1> white = llt.matrixL().solve(m.residual);
  const double nis = white.squaredNorm();
  if (llt.info() != Eigen::Success || !(nis <= gate)) return nis;

  Eigen::Matrix<double, N, M> gain = PHt;
  detail::solveInPlace<N, M>(llt.matrixLLT(), gain);
  detail::subtractOuter<N, M>(P, gain, PHt);
  Eigen::Matrix<double, N, M> excess;  // A H^T - K R, zero but for rounding
  if constexpr (kSelects) {
    for (int k = 0; k < M; ++k) excess.col(k) = P.col(column(k));
  } else {
    excess = detail::timesTransposed<Cols, N, M>(P, m.H);
  }
  for (int i = 0; i < M; ++i)
    for (int k = 0; k < M; ++k) excess.col(i) -= gain.col(k) * m.R(k, i);
  detail::subtractOuter<N, M>(P, excess, gain);
  correct(gain * m.residual);
  return nis;
}

extern template class ErrorStateFilter<kCoreSize>;
extern template class ErrorStateFilter<kFullSize>;

}  // namespace fathom
