#include "core/geometry.h"

#include <algorithm>

namespace fathom {

Matrix3d rotationFromYawPitchRoll(double yaw, double pitch, double roll) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

Vector3d yawPitchRollFromRotation(const Matrix3d& R) {
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < 1e-9) return {0.0, pitch, std::atan2(-R(1, 2), R(1, 1))};
  return {std::atan2(R(1, 0), R(0, 0)), pitch, std::atan2(R(2, 1), R(2, 2))};
}

Matrix3d bodyRotationFromYawPitchRoll(const Vector3d& yaw_pitch_roll) {
  const double sp = std::sin(yaw_pitch_roll[1]), cp = std::cos(yaw_pitch_roll[1]);
  const double sr = std::sin(yaw_pitch_roll[2]), cr = std::cos(yaw_pitch_roll[2]);
  Matrix3d J;
  J << -sp, 0, 1,  //
      sr * cp, cr, 0, cr * cp, -sr, 0;
  return J;
}

Matrix3d rotationBetween(const Vector3d& from, const Vector3d& to) {
  const Vector3d a = from.normalized(), b = to.normalized();
  const double w = std::sqrt(std::max(0.0, 0.5 * (1.0 + a.dot(b))));  // cosine of half the angle
  Eigen::Quaterniond q;
  q.w() = w;
  q.vec() = w > 1e-6 ? Vector3d(a.cross(b) / (2.0 * w)) : a.unitOrthogonal();
  return q.normalized().toRotationMatrix();
}

double angleBetween(const Matrix3d& R_a, const Matrix3d& R_b) {
  return logSO3<double>(R_a.transpose() * R_b).norm();
}

}  // namespace fathom
