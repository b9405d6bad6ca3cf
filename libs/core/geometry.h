#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

/// Rotations and rigid poses. T_a_b maps points of frame b into frame a; R_a_b is its rotation.
/// Everything is templated on the scalar, so that ceres::Jet passes through.
namespace fathom {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double radians(double angle_deg) { return angle_deg * std::numbers::pi / 180.0; }
constexpr double degrees(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }

/// An angle wrapped to [-pi, pi].
inline double wrapAngle(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

/// [v]x: crossMatrix(v) * w = v x w.
template <class T>
Matrix3<T> crossMatrix(const Vector3<T>& v) {
  Matrix3<T> m;
  m << T(0), -v.z(), v.y(), v.z(), T(0), -v.x(), -v.y(), v.x(), T(0);
  return m;
}

namespace detail {
/// sin(a)/a, (1-cos a)/a², (a - sin a)/a³ as functions of a², smooth at zero (series below 1e-4: the next
/// term is under 1e-17 relative).
template <class T>
struct RotationCoefficients {
  T sine, cosine, cubic;
  explicit RotationCoefficients(const T& angle_squared) {
    using std::cos, std::sin, std::sqrt;
    if (angle_squared < 1e-4) {
      const T& q = angle_squared;
      sine = 1.0 - q * (1.0 / 6.0) * (1.0 - q * (1.0 / 20.0) * (1.0 - q * (1.0 / 42.0)));
      cosine = 0.5 * (1.0 - q * (1.0 / 12.0) * (1.0 - q * (1.0 / 30.0) * (1.0 - q * (1.0 / 56.0))));
      cubic = (1.0 - q * (1.0 / 20.0) * (1.0 - q * (1.0 / 42.0) * (1.0 - q * (1.0 / 72.0)))) * (1.0 / 6.0);
    } else {
      const T angle = sqrt(angle_squared);
      sine = sin(angle) / angle;
      cosine = (1.0 - cos(angle)) / angle_squared;
      cubic = (1.0 - sine) / angle_squared;
    }
  }
};
}  // namespace detail

/// Rotation vector (rad) to rotation matrix: Rodrigues' formula.
template <class T>
Matrix3<T> expSO3(const Vector3<T>& r) {
  const detail::RotationCoefficients<T> c(r.squaredNorm());
  const Matrix3<T> K = crossMatrix(r);
  return Matrix3<T>::Identity() + c.sine * K + c.cosine * (K * K);
}

/// Right Jacobian of SO(3): Exp(r + d) = Exp(r) Exp(J d) to first order (Sola et al. 2018, eq. 143).
template <class T>
Matrix3<T> rightJacobianSO3(const Vector3<T>& r) {
  const detail::RotationCoefficients<T> c(r.squaredNorm());
  const Matrix3<T> K = crossMatrix(r);
  return Matrix3<T>::Identity() - c.cosine * K + c.cubic * (K * K);
}

/// Inverse of the right Jacobian, for |r| < 2 pi (Sola et al. 2018, eq. 144).
template <class T>
Matrix3<T> inverseRightJacobianSO3(const Vector3<T>& r) {
  const T q = r.squaredNorm();
  const detail::RotationCoefficients<T> c(q);
  const Matrix3<T> K = crossMatrix(r);
  // (1/q)(1 - sine / (2 cosine)); its series at zero is 1/12 + q/720.
  const T k = q < 1e-4 ? T(1.0 / 12.0 + q / 720.0) : T((1.0 - c.sine / (2.0 * c.cosine)) / q);
  return Matrix3<T>::Identity() + 0.5 * K + k * (K * K);
}

/// Rotation matrix to rotation vector (rad), norm in [0, pi]. By way of the quaternion, which is well
/// conditioned everywhere; differentiable except at pi.
template <class T>
Vector3<T> logSO3(const Matrix3<T>& R) {
  using std::atan2, std::sqrt;
  Eigen::Quaternion<T> q(R);
  if (q.w() < T(0)) q.coeffs() = -q.coeffs();
  const T sine_squared = q.vec().squaredNorm();
  if (sine_squared < 1e-10) {  // atan2(s, w)/s = 1/w (1 - s²/(3 w²)): the next term is under 1e-20
    const T k = 2.0 / q.w() * (1.0 - sine_squared / (3.0 * q.w() * q.w()));
    return k * q.vec();
  }
  const T sine = sqrt(sine_squared);
  return (2.0 * atan2(sine, q.w()) / sine) * q.vec();
}

/// Yaw-pitch-roll (rad), MRPT order: R = Rz(yaw) Ry(pitch) Rx(roll).
Matrix3d rotationFromYawPitchRoll(double yaw, double pitch, double roll);
/// The inverse: (yaw, pitch, roll); at pitch = +-90 deg yaw is chosen zero.
Vector3d yawPitchRollFromRotation(const Matrix3d& R);

/// d(rotation vector in body axes) / d(yaw, pitch, roll): turns a yaw-pitch-roll covariance C (MRPT's order)
/// into one of the rotation vector, J C J^T. Loses rank at pitch = +-90 deg, as the angles do.
Matrix3d bodyRotationFromYawPitchRoll(const Vector3d& yaw_pitch_roll);

/// A rigid transform, T_a_b: rotation R_a_b and b's origin in a.
struct Pose {
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d position = Vector3d::Zero();

  Pose inverse() const { return {rotation.transpose(), -(rotation.transpose() * position)}; }
  friend Pose operator*(const Pose& T_a_b, const Pose& T_b_c) {
    return {T_a_b.rotation * T_b_c.rotation, T_a_b.rotation * T_b_c.position + T_a_b.position};
  }
  friend Vector3d operator*(const Pose& T_a_b, const Vector3d& point_b) {
    return T_a_b.rotation * point_b + T_a_b.position;
  }
};

/// The shortest rotation R that turns one direction (of any length) into another: R from is along to. Of
/// opposite ones, about any axis across them.
Matrix3d rotationBetween(const Vector3d& from, const Vector3d& to);

/// Geodesic distance of two rotations, rad in [0, pi] (Huynh 2009, Phi_6).
double angleBetween(const Matrix3d& R_a, const Matrix3d& R_b);

}  // namespace fathom
