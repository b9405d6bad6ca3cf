#include "core/geometry.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "core/random.h"
#include "recording/mrpt_types.h"

namespace fathom {
namespace {

using Eigen::AngleAxisd;
using std::numbers::pi;

/// Axes at random, with angles from nothing to pi: the hard places are zero, the switch to series, and pi.
std::vector<Vector3d> rotationVectors(double largest = pi) {
  Random random(1);
  std::vector<Vector3d> vectors{Vector3d::Zero(), {largest, 0, 0}, {0, largest, 0}, {0, 0, largest}};
  for (const double angle : {1e-300, 1e-12, 1e-8, 1e-6, 1e-5, 0.00999, 0.01, 0.01001, 0.1, 1.0, 1.5, 2.0, 3.0,
                             pi - 1e-2, pi - 1e-4, pi - 1e-6, pi - 1e-8, pi - 1e-12})
    for (int i = 0; i < 20; ++i)
      vectors.emplace_back(std::min(angle, largest) * random.normal3().normalized());
  return vectors;
}

Matrix3d byAngleAxis(const Vector3d& r) {
  return r.norm() > 0 ? AngleAxisd(r.norm(), r.normalized()).toRotationMatrix() : Matrix3d::Identity().eval();
}

TEST(Geometry, WrapAngle) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.uniform(-50, 50), wrapped = wrapAngle(angle);
    EXPECT_LE(std::abs(wrapped), pi);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-13);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-13);
  }
  EXPECT_NEAR(degrees(radians(77)), 77, 1e-13);
}

TEST(Geometry, CrossMatrix) {
  Random random(3);
  const Vector3d v = random.normal3(), w = random.normal3();
  EXPECT_LT((crossMatrix(v) * w - v.cross(w)).norm(), 1e-15);
}

// Both formulas round a few times in numbers below one.
TEST(Geometry, ExpEqualsAngleAxis) {
  for (const Vector3d& r : rotationVectors())
    EXPECT_LT((expSO3(r) - byAngleAxis(r)).norm(), 2e-15) << r.norm();
}

// Near pi the matrix determines the vector to rounding over its own size: sqrt(eps) is not lost, because the
// quaternion is used. Exactly at pi the sign is free.
TEST(Geometry, LogInvertsExp) {
  for (const Vector3d& r : rotationVectors()) {
    const Vector3d back = logSO3(byAngleAxis(r));
    const double distance = std::min((back - r).norm(), r.norm() > pi - 1e-9 ? (back + r).norm() : 1e9);
    EXPECT_LT(distance, 1e-14 + 1e-15 * r.norm() + (r.norm() > pi - 1e-9 ? 1e-8 : 0)) << r.norm();
    EXPECT_LE(back.norm(), pi + 1e-15);
  }
}

TEST(Geometry, LogIsRelativelyExactForSmallAngles) {
  const Vector3d r = 1e-7 * Vector3d(1, -2, 3);
  EXPECT_LT((logSO3(expSO3(r)) - r).norm(), 1e-16);
}

// Central differences of Exp with step h: error h² plus rounding over h.
TEST(Geometry, RightJacobianEqualsNumeric) {
  constexpr double h = 1e-5;
  for (const Vector3d& r : rotationVectors(3.0)) {
    Matrix3d numeric;
    for (int j = 0; j < 3; ++j) {
      const Vector3d d = h * Vector3d::Unit(j);
      numeric.col(j) = logSO3<double>(byAngleAxis(r - d).transpose() * byAngleAxis(r + d)) / (2 * h);
    }
    EXPECT_LT((rightJacobianSO3(r) - numeric).norm(), 1e-9) << r.norm();
    EXPECT_LT((rightJacobianSO3(r) * inverseRightJacobianSO3(r) - Matrix3d::Identity()).norm(), 1e-12)
        << r.norm();
  }
}

TEST(Geometry, InverseRightJacobianBeyondPi) {
  for (const double angle : {3.3, 4.0, 5.0, 6.0}) {
    const Vector3d r = angle * Vector3d(1, 2, -2) / 3;
    EXPECT_LT((rightJacobianSO3(r) * inverseRightJacobianSO3(r) - Matrix3d::Identity()).norm(), 1e-12);
  }
}

using RotationJet = ceres::Jet<double, 3>;
Vector3<RotationJet> jetVector(const Vector3d& r) {
  return {RotationJet(r[0], 0), RotationJet(r[1], 1), RotationJet(r[2], 2)};
}

// d Exp(r)/d r_j = Exp(r) [J_r e_j]x, and d Log(Exp(r))/dr = 1.
TEST(Geometry, JetsThroughExpAndLog) {
  for (const Vector3d& r : rotationVectors(3.1)) {
    const Matrix3<RotationJet> R = expSO3<RotationJet>(jetVector(r));
    const Vector3<RotationJet> back = logSO3<RotationJet>(R);
    for (int j = 0; j < 3; ++j) {
      const Matrix3d derivative = R.unaryExpr([j](const RotationJet& x) { return x.v[j]; });
      const Matrix3d expected = expSO3(r) * crossMatrix<double>(rightJacobianSO3(r).col(j));
      EXPECT_LT((derivative - expected).norm(), 1e-12) << r.norm();
      const Vector3d round_trip = back.unaryExpr([j](const RotationJet& x) { return x.v[j]; });
      EXPECT_LT((round_trip - Vector3d::Unit(j)).norm(), 1e-12) << r.norm();
    }
  }
}

TEST(Geometry, YawPitchRollIsMrpts) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const double yaw = random.uniform(-pi, pi), roll = random.uniform(-pi, pi);
    const double pitch = random.uniform(-1.57, 1.57);
    const mrpt::poses::CPose3D pose(0, 0, 0, yaw, pitch, roll);
    const Matrix3d R = rotationFromYawPitchRoll(yaw, pitch, roll);
    EXPECT_LT((R - pose.getRotationMatrix().asEigen()).norm(), 4e-15);
    // Near +-90 degrees of pitch an error of the matrix grows by 1/cos(pitch), here up to 1250.
    EXPECT_LT((yawPitchRollFromRotation(R) - Vector3d(yaw, pitch, roll)).norm(),
              1e-15 * 4 / std::cos(pitch) + 1e-15);
  }
}

TEST(Geometry, YawPitchRollAtGimbalLock) {
  for (const double sign : {1.0, -1.0})
    for (const double yaw : {0.0, 0.3, -2.0})
      for (const double roll : {0.0, 0.7, 3.0}) {
        const Matrix3d R = rotationFromYawPitchRoll(yaw, sign * pi / 2, roll);
        const Vector3d ypr = yawPitchRollFromRotation(R);
        EXPECT_EQ(ypr[0], 0.0);
        EXPECT_NEAR(ypr[1], sign * pi / 2, 1e-9);
        EXPECT_LT(angleBetween(rotationFromYawPitchRoll(ypr[0], ypr[1], ypr[2]), R), 1e-9);
        double mrpt_yaw = 0, mrpt_pitch = 0, mrpt_roll = 0;
        toMrpt(Pose{R, Vector3d::Zero()}).getYawPitchRoll(mrpt_yaw, mrpt_pitch, mrpt_roll);
        EXPECT_LT(angleBetween(rotationFromYawPitchRoll(mrpt_yaw, mrpt_pitch, mrpt_roll), R), 1e-6);
      }
}

TEST(Geometry, BodyRotationOfYawPitchRollEqualsNumeric) {
  Random random(5);
  constexpr double h = 1e-5;
  for (int i = 0; i < 100; ++i) {
    const Vector3d ypr(random.uniform(-3, 3), random.uniform(-1.5, 1.5), random.uniform(-3, 3));
    const auto R = [](const Vector3d& a) { return rotationFromYawPitchRoll(a[0], a[1], a[2]); };
    Matrix3d numeric;
    for (int j = 0; j < 3; ++j) {
      const Vector3d d = h * Vector3d::Unit(j);
      numeric.col(j) = logSO3<double>(R(ypr - d).transpose() * R(ypr + d)) / (2 * h);
    }
    EXPECT_LT((bodyRotationFromYawPitchRoll(ypr) - numeric).norm(), 1e-9);
  }
}

TEST(Geometry, RotationBetweenTurnsOneDirectionIntoTheOther) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Vector3d a = random.normal3(),
                   b = i % 4 == 0 ? Vector3d(-a + 1e-9 * i * random.normal3()) : random.normal3();
    const Matrix3d R = rotationBetween(a, b);
    EXPECT_LT((R * a.normalized() - b.normalized()).norm(), 1e-6);
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(angleBetween(R, Matrix3d::Identity()),
                std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)), 1e-6);
  }
}

TEST(Pose, AgreesWithMrpt) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Pose T_a_b{expSO3<double>(2 * random.normal3()), 5 * random.normal3()};
    const Pose T_b_c{expSO3<double>(2 * random.normal3()), 5 * random.normal3()};
    const Vector3d point = random.normal3();
    const auto close = [](const Pose& ours, const mrpt::poses::CPose3D& theirs) {
      const Pose other = fromMrpt(theirs);
      EXPECT_LT((ours.rotation - other.rotation).norm(), 1e-14);
      EXPECT_LT((ours.position - other.position).norm(), 1e-13);
    };
    close(T_a_b, toMrpt(T_a_b));
    close(T_a_b * T_b_c, toMrpt(T_a_b) + toMrpt(T_b_c));
    close(T_a_b.inverse(), -toMrpt(T_a_b));
    mrpt::math::TPoint3D moved;
    toMrpt(T_a_b).composePoint({point.x(), point.y(), point.z()}, moved);
    EXPECT_LT((T_a_b * point - Vector3d(moved.x, moved.y, moved.z)).norm(), 1e-13);
  }
}

TEST(Geometry, AngleBetween) {
  Random random(7);
  for (const double angle : {0.0, 1e-9, 1e-3, 1.0, 3.0, pi}) {
    const Matrix3d R = expSO3<double>(random.normal3());
    const Matrix3d turned = R * AngleAxisd(angle, random.normal3().normalized()).toRotationMatrix();
    EXPECT_NEAR(angleBetween(R, turned), angle, 1e-14);
    EXPECT_NEAR(angleBetween(turned, R), angle, 1e-14);
  }
}

}  // namespace
}  // namespace fathom
