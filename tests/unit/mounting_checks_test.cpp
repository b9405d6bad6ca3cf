// What is said of an INS's mounting by what a robot drove.
#include "ros_bag/mounting_checks.h"

#include <gtest/gtest.h>

#include "support/recordings.h"

namespace fathom {
namespace {

/// Of a robot that speeds up, slows down and turns for a minute, on ground that falls by so much ahead; its
/// INS truly sits turned by `R_robot_ins`, the map says that it does not.
Conclusion drivenOn(double slope_rad, const Matrix3d& R_robot_ins) {
  constexpr double kGravity = 9.81;
  MountingChecks checks(kGravity);
  const BagTopic ins;
  const Vector3d up_robot = rotationFromYawPitchRoll(0, slope_rad, 0).transpose() * Vector3d(0, 0, 1);
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.02 * i;
    const Vector3d velocity(1 + 0.8 * std::sin(0.7 * t), 0, 0), rate(0, 0, 0.4 * std::cos(0.3 * t));
    const Vector3d acceleration = Vector3d(0.56 * std::cos(0.7 * t), 0, 0) + rate.cross(velocity);
    checks.addIns(ins, {}, Vector3d(R_robot_ins.transpose() * (acceleration + kGravity * up_robot)));
    checks.addOdometry(after(test::kStart, t), velocity, rate);
  }
  for (const Conclusion& c : checks.conclusions(ins))
    if (c.what == "INS mounting against odometry") return c;
  return {};
}

TEST(MountingChecks, AreOfAnySlope) {
  for (const double slope_deg : {-20, -12, 0, 12, 20}) {
    const Conclusion c = drivenOn(radians(slope_deg), Matrix3d::Identity());
    EXPECT_EQ(c.concluded, "the map's pose fits best of the 24 right-angled ones")
        << slope_deg << ": " << c.evidence;
    EXPECT_GT(c.residual_ratio, 2);
  }
}

TEST(MountingChecks, AnotherMountingIsNamed) {
  for (const double slope_deg : {0, 12}) {
    const Conclusion c = drivenOn(radians(slope_deg), rotationFromYawPitchRoll(radians(90), 0, 0));
    EXPECT_EQ(c.concluded, "axes (-y, x, z) after the map's pose fit better (not corrected)") << c.evidence;
  }
}

}  // namespace
}  // namespace fathom
