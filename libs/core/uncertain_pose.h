#pragma once

#include "core/geometry.h"

namespace fathom {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A pose and the covariance of x y z yaw pitch roll (m, rad), as rawlogs keep them.
struct YawPitchRollPose {
  Pose mean;
  Matrix6d covariance = Matrix6d::Zero();
};

/// A pose T_a_b and the covariance of (p, r): true position = p + dp in a's axes (m), true rotation = R
/// Exp(dr), dr in b's axes (rad).
struct UncertainPose {
  Pose pose;
  Matrix6d covariance = Matrix6d::Zero();

  /// Near a pitch of +-90 degrees, where those angles lose meaning, their covariance is damped.
  YawPitchRollPose toYawPitchRoll() const;
  static UncertainPose fromYawPitchRoll(const YawPitchRollPose& other);

  /// T_b_a.
  UncertainPose inverse() const;
};

/// T_a_c = T_a_b T_b_c, T_a_b exact.
UncertainPose operator*(const Pose& T_a_b, const UncertainPose& T_b_c);

/// A pose made of two others, and by how much its error (as in UncertainPose) grows with theirs.
struct LinkedPose {
  Pose pose;
  Matrix6d wrt_first, wrt_second;
};
/// T_a_c = T_a_b T_b_c.
LinkedPose composed(const Pose& T_a_b, const Pose& T_b_c);
/// T_a_b = T_o_a^-1 T_o_b.
LinkedPose between(const Pose& T_o_a, const Pose& T_o_b);

/// The error that `to` has against `from`: p_to - p_from, Log(R_from^T R_to).
Vector6d poseDifference(const Pose& from, const Pose& to);

}  // namespace fathom
