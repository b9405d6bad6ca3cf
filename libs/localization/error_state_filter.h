#pragma once

#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/linear_algebra.h"
#include "core/uncertain_pose.h"
#include "localization/frame_move.h"
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

/// Poses that stand still and are estimated along with the motion: T_odom_i (panels). Their errors are those
/// of UncertainPose, six coordinates each.
struct AttachedPoses {
  explicit AttachedPoses(int motion_size) : cross(0, motion_size) {}

  std::vector<Pose> T_odom;
  Eigen::MatrixXd cross;  ///< covariance of their errors (rows) with the motion's
  Eigen::MatrixXd block;  ///< and with each other
};

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
  AttachedPoses attached{N};  ///< costs nothing where there is none

  void predict(double dt_s, const ProcessNoise& noise);

  /// Dense transition Jacobian of one predict step of at most kMaximumStep_s: for the smoother and tests.
  static Matrix transition(const NavigationState<double>& x, double dt_s, const ProcessNoise& noise);
  /// The motion alone.
  static void move(NavigationState<double>& x, double dt_s, const ProcessNoise& noise);
  /// Diagonal of the noise density per second.
  static Vector noiseDensity(const ProcessNoise& noise);

  /// A linearized measurement: residual r = z - h(x), r ~ H error + v, v ~ N(0, R); H against the listed
  /// columns, as many of its own as they are.
  template <int M>
  struct Measurement {
    Eigen::Matrix<double, M, 1> residual;
    Eigen::Matrix<double, M, StateColumns::kMost> H;
    Eigen::Matrix<double, M, M> R;
    StateColumns columns;
  };
  /// The same where H is the identity: a reading of the error coordinates themselves.
  template <class Cols>
  struct Selection {
    static constexpr Cols columns{};
    Eigen::Matrix<double, Cols::size, 1> residual;
    Eigen::Matrix<double, Cols::size, Cols::size> R;
  };

  /// Normalized innovation squared r^T S^-1 r. Fuses when it is at most `gate`.
  /// Joseph form (Bucy & Joseph 1968), expanded as P' = A - (A H^T - K R) K^T with A = P - K (P H^T)^T: the
  /// same stabilized result in O(N² M), symmetric to the last bit.
  template <class AnyMeasurement>
  double update(const AnyMeasurement& m, double gate = std::numeric_limits<double>::infinity());

  /// A pose seen from the robot becomes one more state, by this sighting alone. Returns its index. (Error of
  /// T_odom_robot T_robot_pose to first order in both.)
  int attach(const UncertainPose& T_robot_pose);
  /// The same for one that is attached already: all that was known of it is forgotten.
  void attachAnew(int index, const UncertainPose& T_robot_pose);
  /// Fuse another sighting of an attached pose, or what is known of it from elsewhere; as update().
  double updateSighting(int index, const UncertainPose& T_robot_pose, double gate);
  double updateAttached(int index, const UncertainPose& T_odom_pose, double gate);
  UncertainPose attachedPose(int index) const;

  /// The robot's pose is what the sighting of a pose says, exact or attached, and nothing else: motion and
  /// biases are kept; with them the robot's pose is correlated as the attached one is, and not otherwise.
  void resetPose(const Pose& T_odom_pose, const UncertainPose& T_robot_pose);
  void resetPose(int index, const UncertainPose& T_robot_pose);
  /// Velocity, angular velocity or acceleration (kVelocity …) is zero with this sigma in each axis, whatever
  /// it was before.
  void resetMotion(int block, double sigma);

  /// Everything in the new frame, which is as uncertain as the move is.
  void moveFrame(const FrameMove& move);

  /// Covariance of all: N coordinates of the motion, six of each attached pose.
  Eigen::MatrixXd wholeCovariance() const;
  void setWholeCovariance(const Eigen::MatrixXd& covariance);

 private:
  void step(double dt_s, const ProcessNoise& noise);
  /// Joseph form as printed, over all states.
  double updateWhole(const Eigen::VectorXd& residual, const Eigen::MatrixXd& H, const Eigen::MatrixXd& R,
                     double gate);
  int attachedRow(int index) const { return N + 6 * index; }
  /// Moves the state by delta; P comes with its lower triangle only and is whole after.
  void correctFromLower(const Vector& delta);
};

// ---------------------------------------------------------------------------------------------------------------

namespace detail {

/// What an update of the motion (H against the listed columns; P H^T and gain of the motion's rows) does to
/// the attached poses. Same formula, same resets.
void carryAttached(AttachedPoses& attached, const MatrixView& H, const int* columns, const MatrixView& R,
                   const MatrixView& S, const MatrixView& PHt, const MatrixView& gain,
                   const Eigen::Ref<const Eigen::VectorXd>& residual);

// Products written as sums of columns: the compiler turns them into straight vector code, where Eigen would
// pack the matrices for its large-product kernel.

/// Calls `f.template operator()<j>()` for j = 0 … N-1.
template <int N, class F>
void unrolled(F&& f) {
  [&]<int... j>(std::integer_sequence<int, j...>) { (f.template operator()<j>(), ...); }
  (std::make_integer_sequence<int, N>());
}

/// P H^T, for H against the listed columns.
template <int N, int M>
Eigen::Matrix<double, N, M> timesTransposed(const Eigen::Matrix<double, N, N>& P, const StateColumns& columns,
                                            const Eigen::Matrix<double, M, StateColumns::kMost>& H) {
  Eigen::Matrix<double, N, M> product = P.col(columns.list[0]) * H.col(0).transpose();
  for (int k = 1; k < columns.count; ++k) {
    const auto column = P.col(columns.list[static_cast<std::size_t>(k)]);
    for (int i = 0; i < M; ++i) product.col(i) += column * H(i, k);
  }
  return product;
}

/// The upper triangle becomes the lower one's mirror image.
template <int N>
void mirrorLower(Eigen::Matrix<double, N, N>& P) {
  for (int j = 0; j < N; ++j)
    for (int i = j + 1; i < N; ++i) P(j, i) = P(i, j);
}

/// P -= A B^T in the lower triangle; what is above it is left undefined.
template <int N, int M>
void subtractLower(Eigen::Matrix<double, N, N>& P, const Eigen::Matrix<double, N, M>& A,
                   const Eigen::Matrix<double, N, M>& B) {
  constexpr int kBlock = 4;
  unrolled<(N + kBlock - 1) / kBlock>([&]<int block>() {
    constexpr int kFirst = block * kBlock, kRows = N - kFirst;
    for (int j = kFirst; j < std::min(kFirst + kBlock, N); ++j) {
      Eigen::Matrix<double, kRows, 1> below = P.col(j).template tail<kRows>();
      for (int i = 0; i < M; ++i) below -= A.col(i).template segment<kRows>(kFirst) * B(j, i);
      P.col(j).template tail<kRows>() = below;
    }
  });
}

/// S = L D L^T, L unit lower triangular: the Cholesky factorization without square roots.
template <int M>
struct Factors {
  Eigen::Matrix<double, M, M> L;           ///< below the diagonal
  Eigen::Matrix<double, M, 1> reciprocal;  ///< 1 / D
  bool positive = true;

  explicit Factors(const Eigen::Matrix<double, M, M>& S) : L(S) {
    unrolled<M>([&]<int j>() {
      positive = positive && L(j, j) > 0.0;
      reciprocal[j] = 1.0 / L(j, j);
      if constexpr (j + 1 < M) {
        constexpr int kRest = M - j - 1;
        const Eigen::Matrix<double, kRest, 1> column = L.col(j).template tail<kRest>();
        L.col(j).template tail<kRest>() *= reciprocal[j];
        for (int k = 0; k < kRest; ++k) L.col(j + 1 + k).template tail<kRest>() -= column * L(j + 1 + k, j);
      }
    });
  }
};

/// X S^-1, in place: forward, then backward substitution over whole columns.
template <int N, int M>
void solveInPlace(const Factors<M>& S, Eigen::Matrix<double, N, M>& X) {
  for (int j = 1; j < M; ++j)
    for (int k = 0; k < j; ++k) X.col(j) -= X.col(k) * S.L(j, k);
  X *= S.reciprocal.asDiagonal();
  for (int j = M - 2; j >= 0; --j)
    for (int k = j + 1; k < M; ++k) X.col(j) -= X.col(k) * S.L(k, j);
}

/// An update of N states by M residuals, as far as it does not matter which columns H has: compiled once for
/// each size.
template <int N, int M>
struct Correction {
  Eigen::Matrix<double, N, M> PHt;
  Eigen::Matrix<double, M, M> S;
  Eigen::Matrix<double, N, M> gain;  ///< K
  double nis = 0;
  bool positive = false;

  /// The residual rides along as one more row: one solve gives gain and NIS.
  void solve(const Eigen::Matrix<double, M, 1>& residual);
  /// P becomes A = P - K (P H^T)^T.
  void reduce(Eigen::Matrix<double, N, N>& P) const;
  /// A becomes A - (A H^T - K R) K^T in its lower triangle.
  void stabilize(Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, M>& AHt,
                 const Eigen::Matrix<double, M, M>& R) const;
};

template <int N, int M>
void Correction<N, M>::solve(const Eigen::Matrix<double, M, 1>& residual) {
  Eigen::Matrix<double, N + 1, M> gain_and_weighted;
  gain_and_weighted << PHt, residual.transpose();
  const Factors<M> factors(S);
  solveInPlace(factors, gain_and_weighted);
  gain = gain_and_weighted.template topRows<N>();
  nis = gain_and_weighted.row(N).dot(residual);
  positive = factors.positive;
}

template <int N, int M>
void Correction<N, M>::reduce(Eigen::Matrix<double, N, N>& P) const {
  subtractLower(P, gain, PHt);
  mirrorLower(P);
}

template <int N, int M>
void Correction<N, M>::stabilize(Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, M>& AHt,
                                 const Eigen::Matrix<double, M, M>& R) const {
  Eigen::Matrix<double, N, M> excess = AHt;  // zero but for rounding
  for (int i = 0; i < M; ++i)
    for (int k = 0; k < M; ++k)  // R is mostly diagonal
      if (R(k, i) != 0.0) excess.col(i) -= gain.col(k) * R(k, i);
  subtractLower(A, excess, gain);
}

extern template struct Correction<kCoreSize, 1>;
extern template struct Correction<kCoreSize, 3>;
extern template struct Correction<kCoreSize, 6>;
extern template struct Correction<kFullSize, 1>;
extern template struct Correction<kFullSize, 3>;
extern template struct Correction<kFullSize, 6>;

}  // namespace detail

template <int N>
template <class AnyMeasurement>
double ErrorStateFilter<N>::update(const AnyMeasurement& m, double gate) {
  constexpr int M = decltype(m.residual)::RowsAtCompileTime;
  constexpr bool kSelects = !requires { m.H; };
  const auto column = [&m](int k) { return m.columns.list[static_cast<std::size_t>(k)]; };
  const auto timesHTransposed = [&] {
    if constexpr (kSelects) {
      Eigen::Matrix<double, N, M> product;
      for (int k = 0; k < M; ++k) product.col(k) = P.col(column(k));
      return product;
    } else {
      return detail::timesTransposed<N, M>(P, m.columns, m.H);
    }
  };

  detail::Correction<N, M> correction;
  correction.PHt = timesHTransposed();
  correction.S = m.R;
  if constexpr (kSelects) {
    for (int k = 0; k < M; ++k) correction.S.row(k) += correction.PHt.row(column(k));
  } else {
    for (int k = 0; k < m.columns.count; ++k)
      for (int i = 0; i < M; ++i) correction.S.col(i) += m.H.col(k) * correction.PHt(column(k), i);
  }
  correction.solve(m.residual);
  if (!correction.positive || !(correction.nis <= gate)) return correction.nis;

  if (!attached.T_odom.empty()) {
    const Eigen::MatrixXd H = [&] {
      if constexpr (kSelects)
        return Eigen::MatrixXd::Identity(M, M);
      else
        return Eigen::MatrixXd(m.H.leftCols(m.columns.count));
    }();
    detail::carryAttached(attached, H, m.columns.list.data(), m.R, correction.S, correction.PHt,
                          correction.gain, m.residual);
  }
  correction.reduce(P);
  correction.stabilize(P, timesHTransposed(), m.R);
  correctFromLower(correction.gain * m.residual);
  return correction.nis;
}

extern template class ErrorStateFilter<kCoreSize>;
extern template class ErrorStateFilter<kFullSize>;

}  // namespace fathom
