#include "core/uncertain_pose.h"

#include <Eigen/Cholesky>

namespace fathom {
namespace {

/// d(p, r) / d(x y z yaw pitch roll)
Matrix6d jacobianOf(const Pose& pose) {
  Matrix6d J = Matrix6d::Identity();
  J.bottomRightCorner<3, 3>() = bodyRotationFromYawPitchRoll(yawPitchRollFromRotation(pose.rotation));
  return J;
}

}  // namespace

mrpt::poses::CPose3DPDFGaussian UncertainPose::toMrpt() const {
  constexpr double kDamping = 1e-12;  // a sigma of a degree stays below one of 10^6
  const Matrix6d J = jacobianOf(pose);
  const Matrix6d inverse =
      (J.transpose() * J + kDamping * Matrix6d::Identity()).ldlt().solve(Matrix6d(J.transpose()));
  const Matrix6d cov = inverse * covariance * inverse.transpose();
  return {pose.toMrpt(), mrpt::math::CMatrixDouble66(cov)};
}

UncertainPose UncertainPose::fromMrpt(const mrpt::poses::CPose3DPDFGaussian& pdf) {
  const Pose pose = Pose::fromMrpt(pdf.mean);
  const Matrix6d J = jacobianOf(pose);
  return {pose, J * pdf.cov.asEigen() * J.transpose()};
}

}  // namespace fathom
