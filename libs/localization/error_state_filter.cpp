#include "localization/error_state_filter.h"

#include <cmath>
#include <stdexcept>

#include "core/gauss_markov.h"
#include "core/linear_algebra.h"

namespace fathom {
namespace {

/// Exp(r), the right Jacobian at r.
struct Turn {
  Matrix3d rotation, jacobian;

  explicit Turn(const Vector3d& r) {
    const detail::RotationCoefficients<double> c(r.squaredNorm());
    const Matrix3d K = crossMatrix<double>(r), square = K * K;
    rotation = Matrix3d::Identity() + c.sine * K + c.cosine * square;
    jacobian = Matrix3d::Identity() - c.cosine * K + c.cubic * square;
  }
};

TransitionBlocks transitionBlocks(const KinematicState<double>& m, double dt) {
  const Turn half(m.angular_velocity_robot * (0.5 * dt));
  const Vector3d way = m.velocity_robot * dt + m.acceleration_robot * (0.5 * dt * dt);
  const Matrix3d half_back = half.rotation.transpose();
  TransitionBlocks b;
  b.dt = dt;
  b.back = half_back * half_back;
  b.half_back = half_back * dt;
  b.position_orientation = -m.R_odom_robot * crossMatrix<double>(way);
  b.position_way = m.R_odom_robot;
  // Jr(2 h) = (1 + Exp(h)^T) Jr(h) / 2: it is the mean of Exp(-s h) over s from 0 to 2.
  b.rate_to_angle = (0.5 * dt) * (half.jacobian + half_back * half.jacobian);
  b.rate_to_velocity = crossMatrix<double>(b.back * m.velocity_robot) * b.rate_to_angle +
                       crossMatrix<double>(b.half_back * m.acceleration_robot) * half.jacobian * (0.5 * dt);
  return b;
}

/// The motion over a step; back = Exp(omega dt)^T, half_back = Exp(omega dt/2)^T dt.
void moveBy(KinematicState<double>& m, const Matrix3d& back, const Matrix3d& half_back, double dt) {
  m.position_odom += m.R_odom_robot * (m.velocity_robot * dt + m.acceleration_robot * (0.5 * dt * dt));
  m.velocity_robot = back * m.velocity_robot + half_back * m.acceleration_robot;
  m.R_odom_robot = m.R_odom_robot * back.transpose();
}

/// What is left of a bias after a step.
double biasDecay(double dt, const ProcessNoise& noise) {
  return GaussMarkovStep(dt, noise.bias_time_constant_s).decay;
}

void decayBiases(NavigationState<double>& x, double decay) {
  x.gyro_bias_rad_s *= decay;
  x.accelerometer_bias_m_s2 *= decay;
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
    const double k = gaussMarkovDensity(noise.bias_time_constant_s);
    q.template segment<3>(kGyroBias) = k * noise.gyro_bias_sigma_rad_s.cwiseAbs2();
    q.template segment<3>(kAccelerometerBias) = k * noise.accelerometer_bias_sigma_m_s2.cwiseAbs2();
    q[kSeaFloor] = noise.sea_floor;
  }
  return q;
}

template <int N>
void ErrorStateFilter<N>::move(NavigationState<double>& x, double dt, const ProcessNoise& noise) {
  const Matrix3d half_back = expSO3<double>(x.motion.angular_velocity_robot * (-0.5 * dt));
  moveBy(x.motion, half_back * half_back, half_back * dt, dt);
  if constexpr (N == kFullSize) decayBiases(x, biasDecay(dt, noise));
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
  F.template block<3, 3>(kVelocity, kAcceleration) = b.half_back;
  if constexpr (N == kFullSize) F.template block<6, 6>(kGyroBias, kGyroBias) *= biasDecay(dt, noise);
  return F;
}

namespace {

/// B F^T in place, whatever B's rows, decay of the biases aside.
void timesTransitionTransposed(Eigen::MatrixXd& B, const TransitionBlocks& f) {
  const auto angle = B.middleCols<3>(kOrientation), velocity = B.middleCols<3>(kVelocity),
             rate = B.middleCols<3>(kAngularVelocity), push = B.middleCols<3>(kAcceleration);
  const Eigen::MatrixX3d position =
                             B.middleCols<3>(kPosition) + angle * f.position_orientation.transpose() +
                             (velocity * f.dt + push * (0.5 * f.dt * f.dt)) * f.position_way.transpose(),
                         orientation = angle * f.back.transpose() + rate * f.rate_to_angle.transpose();
  B.middleCols<3>(kVelocity) =
      (velocity * f.back.transpose() + rate * f.rate_to_velocity.transpose() + push * f.half_back.transpose())
          .eval();
  B.middleCols<3>(kPosition) = position;
  B.middleCols<3>(kOrientation) = orientation;
}

}  // namespace

template <int N>
void ErrorStateFilter<N>::step(double dt, const ProcessNoise& noise) {
  const TransitionBlocks f = transitionBlocks(x.motion, dt);
  const Vector half_noise = (0.5 * dt) * noiseDensity(noise);
  const double decay = N == kFullSize ? biasDecay(dt, noise) : 1.0;
  kernels->propagate(P.padded(), f, half_noise.data(), decay);
  if (!attached.T_odom.empty()) {
    if constexpr (N == kFullSize) attached.cross.template middleCols<6>(kGyroBias) *= decay;
    timesTransitionTransposed(attached.cross, f);
  }
  moveBy(x.motion, f.back, f.half_back, dt);
  if constexpr (N == kFullSize) decayBiases(x, decay);
}

template <int N>
void ErrorStateFilter<N>::correct(const Border<N>& border) {
  kernels->subtract(P.padded(), border);
  Vector delta;
  for (int k = 0; k < N; ++k) delta[k] = -P.padded()[k * (N + 1) + N];
  const Turn turn(delta.template segment<3>(kOrientation));
  retract<N>(x, delta, turn.rotation);
  // The error is from now on measured in the tangent space at the corrected attitude (Sola 2017, eq. 287).
  kernels->turn(P.padded(), turn.jacobian);
}

template <int N>
void ErrorStateFilter<N>::predict(double dt_s, const ProcessNoise& noise) {
  if (!(dt_s >= 0.0 && std::isfinite(dt_s)))
    throw std::invalid_argument("a prediction over " + std::to_string(dt_s) + " s");
  const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / kMaximumStep_s - 1e-9)));
  for (int k = 0; k < steps; ++k) step(dt_s / steps, noise);
}

namespace {

/// The attached poses moved by their share of a correction; returns the blocks that reset their rotations'
/// errors, on the diagonal of an otherwise identity matrix.
Eigen::MatrixXd moveAttached(std::vector<Pose>& poses, const Eigen::VectorXd& delta) {
  Eigen::MatrixXd reset = Eigen::MatrixXd::Identity(delta.size(), delta.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    poses[i].position += delta.segment<3>(row);
    poses[i].rotation = poses[i].rotation * expSO3<double>(delta.segment<3>(row + 3));
    reset.block<3, 3>(row + 3, row + 3) = rightJacobianSO3<double>(delta.segment<3>(row + 3));
  }
  return reset;
}

}  // namespace

template <int N>
void ErrorStateFilter<N>::carryAttached(const Eigen::VectorXd& residual, const Eigen::MatrixXd& H,
                                        const Eigen::MatrixXd& R) {
  const auto H_motion = H.leftCols<N>();
  const Eigen::MatrixXd PHt = P * H_motion.transpose(), own = attached.cross * H_motion.transpose();
  const SymmetricFactors S(H_motion * PHt + R);
  const Eigen::MatrixXd gain = S.solve(PHt.transpose()).transpose(),
                        own_gain = S.solve(own.transpose()).transpose();
  attached.cross -= own_gain * PHt.transpose();
  const Eigen::MatrixXd excess = attached.cross * H_motion.transpose() - own_gain * R;
  attached.cross -= excess * gain.transpose();
  attached.block -= own_gain * own.transpose() + excess * own_gain.transpose();

  const Matrix3d robot = rightJacobianSO3<double>(gain.middleRows<3>(kOrientation) * residual);
  attached.cross.template middleCols<3>(kOrientation) *= robot.transpose();
  const Eigen::MatrixXd reset = moveAttached(attached.T_odom, own_gain * residual);
  attached.cross = (reset * attached.cross).eval();
  const Eigen::MatrixXd block = reset * attached.block * reset.transpose();
  attached.block = 0.5 * (block + block.transpose());
}

namespace {

Eigen::MatrixXd joined(const MatrixView& P, const AttachedPoses& attached) {
  const Eigen::Index motion = P.rows(), rest = attached.block.rows();
  Eigen::MatrixXd whole(motion + rest, motion + rest);
  whole.topLeftCorner(motion, motion) = P;
  whole.bottomLeftCorner(rest, motion) = attached.cross;
  whole.topRightCorner(motion, rest) = attached.cross.transpose();
  whole.bottomRightCorner(rest, rest) = attached.block;
  return whole;
}

/// Symmetrized; what is the motion's own is returned.
Eigen::MatrixXd takenApart(const Eigen::MatrixXd& covariance, Eigen::Index motion, AttachedPoses& attached) {
  const Eigen::MatrixXd whole = 0.5 * (covariance + covariance.transpose());
  const Eigen::Index rest = whole.rows() - motion;
  attached.cross = whole.bottomLeftCorner(rest, motion);
  attached.block = whole.bottomRightCorner(rest, rest);
  return whole.topLeftCorner(motion, motion);
}

/// Joseph form as printed, over all states; moves the attached poses where it fuses.
struct WholeUpdate {
  Update done;
  Eigen::VectorXd delta;
  Eigen::MatrixXd covariance;

  WholeUpdate(const Eigen::MatrixXd& before, const Eigen::VectorXd& residual, const Eigen::MatrixXd& H,
              const Eigen::MatrixXd& R, double gate, std::vector<Pose>& poses) {
    const Eigen::MatrixXd PHt = before * H.transpose();
    const Eigen::MatrixXd variance = H * PHt + R;
    const SymmetricFactors S(variance);
    const double nis = residual.dot(S.solve(residual));
    done = {nis, std::exp(S.logDeterminant()), S.isPositive() && nis <= gate, {}};
    for (Eigen::Index k = 0; k < residual.size(); ++k)
      done.variances[static_cast<std::size_t>(k)] = variance(k, k);
    if (!done.fused) return;
    const Eigen::MatrixXd gain = S.solve(PHt.transpose()).transpose();
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(before.rows(), before.rows()) - gain * H;
    delta = gain * residual;
    const auto attached = 6 * std::ssize(poses);
    Eigen::MatrixXd reset = Eigen::MatrixXd::Identity(before.rows(), before.rows());
    reset.block<3, 3>(kOrientation, kOrientation) = rightJacobianSO3<double>(delta.segment<3>(kOrientation));
    reset.bottomRightCorner(attached, attached) = moveAttached(poses, delta.tail(attached));
    covariance = reset * (rest * before * rest.transpose() + gain * R * gain.transpose()) * reset.transpose();
  }
};

/// The rows of a pose from `row` on are those of the robot's pose, seen through the sighting; the own columns
/// come last.
void seeAnew(Eigen::MatrixXd& whole, Eigen::Index row, const LinkedPose& link, const Matrix6d& sighting) {
  const Matrix6d robot = whole.topLeftCorner<6, 6>();
  const Eigen::MatrixXd rows = link.wrt_first * whole.topRows<6>();
  whole.middleRows<6>(row) = rows;
  whole.middleCols<6>(row) = rows.transpose();
  whole.block<6, 6>(row, row) = link.wrt_first * robot * link.wrt_first.transpose() +
                                link.wrt_second * sighting * link.wrt_second.transpose();
}

}  // namespace

template <int N>
Eigen::MatrixXd ErrorStateFilter<N>::wholeCovariance() const {
  return joined(P, attached);
}

template <int N>
void ErrorStateFilter<N>::setWholeCovariance(const Eigen::MatrixXd& covariance) {
  P = takenApart(covariance, N, attached);
}

template <int N>
Update ErrorStateFilter<N>::updateWhole(const Eigen::VectorXd& residual, const Eigen::MatrixXd& H,
                                        const Eigen::MatrixXd& R, double gate) {
  const WholeUpdate update(wholeCovariance(), residual, H, R, gate, attached.T_odom);
  if (!update.done.fused) return update.done;
  retract<N>(x, update.delta.head<N>());
  setWholeCovariance(update.covariance);
  return update.done;
}

template <int N>
int ErrorStateFilter<N>::attach(const UncertainPose& T_robot_pose) {
  const Eigen::Index rows = attached.block.rows() + 6;
  attached.T_odom.emplace_back();
  attached.cross.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, N));
  attached.block.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, rows));
  const int index = static_cast<int>(attached.T_odom.size()) - 1;
  attachAnew(index, T_robot_pose);
  return index;
}

template <int N>
void ErrorStateFilter<N>::attachAnew(int index, const UncertainPose& T_robot_pose) {
  const LinkedPose link = composed({x.motion.R_odom_robot, x.motion.position_odom}, T_robot_pose.pose);
  attached.T_odom[static_cast<std::size_t>(index)] = link.pose;
  Eigen::MatrixXd whole = wholeCovariance();
  seeAnew(whole, attachedRow(index), link, T_robot_pose.covariance);
  setWholeCovariance(whole);
}

template <int N>
Update ErrorStateFilter<N>::updateSighting(int index, const UncertainPose& T_robot_pose, double gate) {
  const auto [predicted, wrt_robot, wrt_pose] = between({x.motion.R_odom_robot, x.motion.position_odom},
                                                        attached.T_odom[static_cast<std::size_t>(index)]);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6, N + attached.block.rows());
  H.leftCols<6>() = wrt_robot;
  H.middleCols<6>(attachedRow(index)) = wrt_pose;
  return updateWhole(poseDifference(predicted, T_robot_pose.pose), H, T_robot_pose.covariance, gate);
}

template <int N>
Update ErrorStateFilter<N>::updateAttached(int index, const UncertainPose& T_odom_pose, double gate) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6, N + attached.block.rows());
  H.middleCols<6>(attachedRow(index)).setIdentity();
  return updateWhole(poseDifference(attached.T_odom[static_cast<std::size_t>(index)], T_odom_pose.pose), H,
                     T_odom_pose.covariance, gate);
}

template <int N>
UncertainPose ErrorStateFilter<N>::attachedPose(int index) const {
  return {attached.T_odom[static_cast<std::size_t>(index)],
          attached.block.template block<6, 6>(6 * index, 6 * index)};
}

template <int N>
void ErrorStateFilter<N>::resetPose(const Pose& T_odom_pose, const UncertainPose& T_robot_pose) {
  const UncertainPose T_odom_robot = T_odom_pose * T_robot_pose.inverse();
  x.motion.position_odom = T_odom_robot.pose.position;
  x.motion.R_odom_robot = T_odom_robot.pose.rotation;
  P.template topRows<6>().setZero();
  P.template leftCols<6>().setZero();
  P.template topLeftCorner<6, 6>() = T_odom_robot.covariance;
  attached.cross.template leftCols<6>().setZero();
}

template <int N>
void ErrorStateFilter<N>::resetPose(int index, const UncertainPose& T_robot_pose) {
  const UncertainPose T_pose_robot = T_robot_pose.inverse();
  const auto [T_odom_robot, wrt_pose, wrt_sighting] =
      composed(attached.T_odom[static_cast<std::size_t>(index)], T_pose_robot.pose);
  resetPose(attached.T_odom[static_cast<std::size_t>(index)], T_robot_pose);
  // The robot's error is now a function of the attached pose's and the sighting's: it inherits the
  // correlations.
  P.template topLeftCorner<6, 6>() += wrt_pose * attachedPose(index).covariance * wrt_pose.transpose();
  P.template topRightCorner<6, N - 6>() = wrt_pose * attached.cross.template block<6, N - 6>(6 * index, 6);
  P.template bottomLeftCorner<N - 6, 6>() = P.template topRightCorner<6, N - 6>().transpose();
  attached.cross.template leftCols<6>() =
      attached.block.template middleCols<6>(6 * index) * wrt_pose.transpose();
}

template <int N>
void ErrorStateFilter<N>::resetMotion(int block, double sigma) {
  Vector3d& motion = block == kVelocity          ? x.motion.velocity_robot
                     : block == kAngularVelocity ? x.motion.angular_velocity_robot
                                                 : x.motion.acceleration_robot;
  motion.setZero();
  P.template middleRows<3>(block).setZero();
  P.template middleCols<3>(block).setZero();
  P.diagonal().template segment<3>(block).setConstant(sigma * sigma);
  attached.cross.template middleCols<3>(block).setZero();
}

template <int N>
void ErrorStateFilter<N>::widenPrior(int coordinate, double value, double before, double after) {
  const double variance = 1.0 / (1.0 / (after * after) - 1.0 / (before * before));  // negative
  Eigen::MatrixXd covariance = wholeCovariance();
  const Eigen::VectorXd column = covariance.col(coordinate);
  const Eigen::VectorXd gain = column / (column[coordinate] + variance), delta = -value * gain;
  covariance -= gain * column.transpose();
  const auto attached_size = 6 * std::ssize(attached.T_odom);
  Eigen::MatrixXd reset = Eigen::MatrixXd::Identity(covariance.rows(), covariance.rows());
  reset.block<3, 3>(kOrientation, kOrientation) = rightJacobianSO3<double>(delta.segment<3>(kOrientation));
  reset.bottomRightCorner(attached_size, attached_size) =
      moveAttached(attached.T_odom, delta.tail(attached_size));
  retract<N>(x, delta.head<N>());
  setWholeCovariance(reset * covariance * reset.transpose());
}

template <int N>
void ErrorStateFilter<N>::moveFrame(const FrameMove& move) {
  const Matrix3d& turn = move.T_new_old.rotation;
  const auto attached_count = std::ssize(attached.T_odom);
  x.motion.position_odom = move.T_new_old * x.motion.position_odom;
  x.motion.R_odom_robot = turn * x.motion.R_odom_robot;
  if constexpr (N == kFullSize) x.sea_floor_z_m += move.T_new_old.position.z();
  for (Pose& pose : attached.T_odom) pose = move.T_new_old * pose;

  // Positions' errors are in odom's axes; rotations' are in their own.
  Eigen::MatrixXd turned = Eigen::MatrixXd::Identity(N + 6 * attached_count, N + 6 * attached_count);
  // What the errors of all are by those of the move: shift along three axes, turn about z through the pivot.
  Eigen::MatrixXd by_move = Eigen::MatrixXd::Zero(turned.rows(), 4);
  const auto addPose = [&](Eigen::Index row, const Matrix3d& R, const Vector3d& position) {
    turned.block<3, 3>(row, row) = turn;
    by_move.block<3, 3>(row, 0).setIdentity();
    by_move.block<3, 1>(row, 3) = Vector3d::UnitZ().cross(position - move.pivot_new);
    by_move.block<3, 1>(row + 3, 3) = R.transpose() * Vector3d::UnitZ();
  };
  addPose(kPosition, x.motion.R_odom_robot, x.motion.position_odom);
  if constexpr (N == kFullSize) by_move(kSeaFloor, 2) = 1.0;
  for (std::ptrdiff_t i = 0; i < attached_count; ++i) {
    const Pose& pose = attached.T_odom[static_cast<std::size_t>(i)];
    addPose(N + 6 * i, pose.rotation, pose.position);
  }
  setWholeCovariance(turned * wholeCovariance() * turned.transpose() +
                     by_move * move.sigma.cwiseAbs2().asDiagonal() * by_move.transpose());
}

template class ErrorStateFilter<kCoreSize>;
template class ErrorStateFilter<kFullSize>;

}  // namespace fathom
