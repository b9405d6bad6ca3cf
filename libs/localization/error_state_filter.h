#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/linear_algebra.h"
#include "core/uncertain_pose.h"
#include "localization/covariance_kernels.h"
#include "localization/frame_move.h"
#include "localization/navigation_state.h"
#include "localization/padded_matrix.h"

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

/// What became of a measurement.
struct Update {
  double nis = 0.0;          ///< normalized innovation squared, r^T S^-1 r
  double determinant = 0.0;  ///< of the innovation's covariance S
  bool fused =
      false;  ///< false: NIS beyond the gate or no number, or S not positive definite; nothing is changed
  std::array<double, Border<kCoreSize>::kMost> variances{};  ///< diagonal of S: the first M
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
  PaddedMatrix<N> P = Matrix::Identity();
  AttachedPoses attached{N};  ///< costs nothing where there is none
  const CovarianceKernels<N>* kernels = &fastestKernels<N>();

  /// Throws std::invalid_argument where dt is negative or no number.
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

  /// Fuses where NIS is at most `gate`.
  ///
  /// P' = P - W D^-1 W^T, where S = L D L^T and W = P H^T L^-T: the same as P - K S K^T, in O(N² M) and
  /// symmetric to the last bit. It loses digits in the ratio of what a component of the reading is known to
  /// before and after; where that is large, as of a precise reading of a state that nothing is known of, the
  /// Joseph form (Bucy & Joseph 1968) is computed instead, which stays positive definite.
  template <class AnyMeasurement>
  Update update(const AnyMeasurement& m, double gate = std::numeric_limits<double>::infinity());

  /// A pose seen from the robot becomes one more state, by this sighting alone. Returns its index. (Error of
  /// T_odom_robot T_robot_pose to first order in both.)
  int attach(const UncertainPose& T_robot_pose);
  /// The same for one that is attached already: all that was known of it is forgotten.
  void attachAnew(int index, const UncertainPose& T_robot_pose);
  /// Fuse another sighting of an attached pose, or what is known of it from elsewhere; as update().
  Update updateSighting(int index, const UncertainPose& T_robot_pose, double gate);
  Update updateAttached(int index, const UncertainPose& T_odom_pose, double gate);
  UncertainPose attachedPose(int index) const;

  /// The robot's pose is what the sighting of a pose says, exact or attached, and nothing else: motion and
  /// biases are kept; with them the robot's pose is correlated as the attached one is, and not otherwise.
  void resetPose(const Pose& T_odom_pose, const UncertainPose& T_robot_pose);
  void resetPose(int index, const UncertainPose& T_robot_pose);
  /// Velocity, angular velocity or acceleration (kVelocity …) is zero with this sigma in each axis, whatever
  /// it was before.
  void resetMotion(int block, double sigma);

  /// An error coordinate whose state was zero beforehand to sigma `before` was so to `after` only, which is
  /// more: what its prior has told of all states is taken back (a reading of zero of negative variance),
  /// exactly where it has not changed since. `value`: of the state.
  void widenPrior(int coordinate, double value, double before, double after);

  /// Everything in the new frame, which is as uncertain as the move is.
  void moveFrame(const FrameMove& move);

  /// Covariance of all: N coordinates of the motion, six of each attached pose.
  Eigen::MatrixXd wholeCovariance() const;
  void setWholeCovariance(const Eigen::MatrixXd& covariance);

 private:
  void step(double dt_s, const ProcessNoise& noise);
  template <class AnyMeasurement>
  void fillBorder(const AnyMeasurement& m, Border<N>& border) const;
  /// H against all states.
  template <class AnyMeasurement>
  Eigen::MatrixXd wholeH(const AnyMeasurement& m) const;
  /// What an update of the motion does to the attached poses, before P is changed: Joseph form, too.
  void carryAttached(const Eigen::VectorXd& residual, const Eigen::MatrixXd& H, const Eigen::MatrixXd& R);
  /// Joseph form as printed, over all states.
  Update updateWhole(const Eigen::VectorXd& residual, const Eigen::MatrixXd& H, const Eigen::MatrixXd& R,
                     double gate);
  int attachedRow(int index) const { return N + 6 * index; }
  /// P - W D^-1 W^T, and the state moved by the correction that comes with it.
  void correct(const Border<N>& border);
};

// ---------------------------------------------------------------------------------------------------------------

template <int N>
template <class AnyMeasurement>
Update ErrorStateFilter<N>::update(const AnyMeasurement& m, double gate) {
  Border<N> border;
  fillBorder(m, border);
  Update done;
  static_assert(decltype(m.residual)::RowsAtCompileTime <= Border<N>::kMost);
  for (int k = 0; k < border.size; ++k) done.variances[static_cast<std::size_t>(k)] = border.columnOfS(k)[k];
  if (!border.isModest(m.R.diagonal()) || !kernels->eliminate(border))
    return updateWhole(m.residual, wholeH(m), m.R, gate);
  done.nis = border.nis();
  done.determinant = border.determinant();
  done.fused = done.nis <= gate;
  if (!done.fused) return done;
  if (!attached.T_odom.empty()) carryAttached(m.residual, wholeH(m), m.R);
  correct(border);
  return done;
}

template <int N>
template <class AnyMeasurement>
void ErrorStateFilter<N>::fillBorder(const AnyMeasurement& m, Border<N>& border) const {
  constexpr int M = decltype(m.residual)::RowsAtCompileTime;
  constexpr bool kSelects = !requires { m.H; };
  const auto column = [&m](int k) { return m.columns.list[static_cast<std::size_t>(k)]; };
  border.begin(M);
  if constexpr (!kSelects) kernels->project(P.padded(), m.columns, m.H.data(), border);
  for (int j = 0; j < M; ++j) {
    double* const PHt = border.column(j);
    double* const S = border.columnOfS(j);
    if constexpr (kSelects) std::copy_n(P.padded() + column(j) * (N + 1), N, PHt);
    for (int i = j; i < M; ++i) {
      S[i] = m.R(i, j);
      if constexpr (kSelects)
        S[i] += PHt[column(i)];
      else
        for (int k = 0; k < m.columns.count; ++k) S[i] += m.H(i, k) * PHt[column(k)];
    }
    PHt[N] = m.residual[j];
  }
}

template <int N>
template <class AnyMeasurement>
Eigen::MatrixXd ErrorStateFilter<N>::wholeH(const AnyMeasurement& m) const {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m.residual.size(), N + attached.block.rows());
  if constexpr (requires { m.H; })
    for (int k = 0; k < m.columns.count; ++k) H.col(m.columns.list[static_cast<std::size_t>(k)]) = m.H.col(k);
  else
    for (int k = 0; k < m.columns.size; ++k) H(k, m.columns.list[static_cast<std::size_t>(k)]) = 1.0;
  return H;
}

extern template class ErrorStateFilter<kCoreSize>;
extern template class ErrorStateFilter<kFullSize>;

}  // namespace fathom
