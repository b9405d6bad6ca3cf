#pragma once

#include "core/geometry.h"

/// Attitudes as other programs write them.
namespace fathom {

/// East-north-up axes from north-east-down ones.
inline Matrix3d enuFromNed() {
  Matrix3d m;
  m << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return m;
}

/// The same roll and pitch, the heading counted the other way round.
inline Matrix3d withHeadingReversed(const Matrix3d& R) {
  const Vector3d ypr = yawPitchRollFromRotation(R);
  return rotationFromYawPitchRoll(-ypr[0], ypr[1], ypr[2]);
}

/// The same heading, and pitch or roll counted the other way round.
inline Matrix3d withPitchReversed(const Matrix3d& R) {
  const Vector3d ypr = yawPitchRollFromRotation(R);
  return rotationFromYawPitchRoll(ypr[0], -ypr[1], ypr[2]);
}
inline Matrix3d withRollReversed(const Matrix3d& R) {
  const Vector3d ypr = yawPitchRollFromRotation(R);
  return rotationFromYawPitchRoll(ypr[0], ypr[1], -ypr[2]);
}

/// What was meant where w, x, y, z were written and x, y, z, w read.
inline Matrix3d attitudeWFirst(const Matrix3d& read) {
  const Eigen::Quaterniond q(read);
  return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
}

}  // namespace fathom
