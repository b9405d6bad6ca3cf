#include "core/uncertain_pose.h"

#include "core/linear_algebra.h"

namespace fathom {
namespace {

/// d(p, r) / d(x y z yaw pitch roll)
Matrix6d jacobianOf(const Pose& pose) {
  Matrix6d J = Matrix6d::Identity();
  J.bottomRightCorner<3, 3>() = bodyRotationFromYawPitchRoll(yawPitchRollFromRotation(pose.rotation));
  return J;
}

}  // namespace

YawPitchRollPose UncertainPose::toYawPitchRoll() const {
  constexpr double kDamping = 1e-12;  // a sigma of a degree stays below one of 10^6
  const Matrix6d J = jacobianOf(pose);
  const Matrix6d inverse = solveSymmetric(J.transpose() * J + kDamping * Matrix6d::Identity(), J.transpose());
  return {pose, inverse * covariance * inverse.transpose()};
}

UncertainPose UncertainPose::fromYawPitchRoll(const YawPitchRollPose& other) {
  const Matrix6d J = jacobianOf(other.mean);
  return {other.mean, J * other.covariance * J.transpose()};
}

UncertainPose UncertainPose::inverse() const {
  const auto [T_b_a, J, unused] = between(pose, Pose{});
  return {T_b_a, J * covariance * J.transpose()};
}

UncertainPose operator*(const Pose& T_a_b, const UncertainPose& T_b_c) {
  const auto [T_a_c, unused, J] = composed(T_a_b, T_b_c.pose);
  return {T_a_c, J * T_b_c.covariance * J.transpose()};
}

LinkedPose composed(const Pose& T_a_b, const Pose& T_b_c) {
  LinkedPose link{T_a_b * T_b_c, Matrix6d::Zero(), Matrix6d::Identity()};
  // p = p1 + R1 Exp(dr1) p2, R = R1 Exp(dr1) R2 = R1 R2 Exp(R2^T dr1).
  link.wrt_first.topLeftCorner<3, 3>().setIdentity();
  link.wrt_first.topRightCorner<3, 3>() = -T_a_b.rotation * crossMatrix<double>(T_b_c.position);
  link.wrt_first.bottomRightCorner<3, 3>() = T_b_c.rotation.transpose();
  link.wrt_second.topLeftCorner<3, 3>() = T_a_b.rotation;
  return link;
}

LinkedPose between(const Pose& T_o_a, const Pose& T_o_b) {
  LinkedPose link{T_o_a.inverse() * T_o_b, Matrix6d::Zero(), Matrix6d::Identity()};
  // p = Exp(-dr_a) Ra^T (pb - pa), R = Exp(-dr_a) Ra^T Rb = R Exp(-R^T dr_a).
  const Matrix3d R_a_o = T_o_a.rotation.transpose();
  link.wrt_first.topLeftCorner<3, 3>() = -R_a_o;
  link.wrt_first.topRightCorner<3, 3>() = crossMatrix<double>(link.pose.position);
  link.wrt_first.bottomRightCorner<3, 3>() = -link.pose.rotation.transpose();
  link.wrt_second.topLeftCorner<3, 3>() = R_a_o;
  return link;
}

Vector6d poseDifference(const Pose& from, const Pose& to) {
  Vector6d difference;
  difference << to.position - from.position, logSO3<double>(from.rotation.transpose() * to.rotation);
  return difference;
}

}  // namespace fathom
