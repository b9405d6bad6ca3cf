#pragma once

#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "core/geometry.h"

namespace fathom {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A pose T_a_b and the covariance of (p, r): true position = p + dp in a's axes (m), true rotation = R
/// Exp(dr), dr in b's axes (rad).
struct UncertainPose {
  Pose pose;
  Matrix6d covariance = Matrix6d::Zero();

  /// MRPT's order x y z yaw pitch roll. Near a pitch of +-90 degrees, where those angles lose meaning, the
  /// angles' covariance is damped.
  mrpt::poses::CPose3DPDFGaussian toMrpt() const;
  static UncertainPose fromMrpt(const mrpt::poses::CPose3DPDFGaussian& pdf);
};

}  // namespace fathom
