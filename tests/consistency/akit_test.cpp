// The real sea trial's seven sections: their conclusions must agree, and what is imported must be consistent.
#include <gtest/gtest.h>

#include "core/files.h"
#include "sea_trial/conventions.h"
#include "sea_trial/import_sea_trial.h"
#include "sensors/vehicle.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

constexpr int kSections = 7;

class Akit : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { FATHOM_NEEDS_SHARED("data/akit"); }
  static SeaTrialFiles files() { return seaTrialFiles(test::sharedData("data/akit"), GetParam()); }
};

/// What every section alone must find. A mirror image of the IMU's y axis is what the data says: gyro and
/// accelerometer agree on it, and no rotation of a right-handed IMU explains it.
TEST_P(Akit, EverySectionConcludesTheSame) {
  const SeaTrialConventions c = establishConventions(readSeaTrial(files()));
  const SignedAxes flipped_y{{0, 1, 2}, {1, -1, 1}};
  EXPECT_FALSE(c.position_columns_swapped);
  EXPECT_EQ(c.altitude_sign, 1);
  EXPECT_EQ(c.attitude_sign, Vector3d::Ones());
  EXPECT_EQ(c.gyro, flipped_y) << c.gyro.text();
  EXPECT_EQ(c.accelerometer, flipped_y) << c.accelerometer.text();
  EXPECT_EQ(c.dvl, SignedAxes{}) << c.dvl.text();
  EXPECT_EQ(c.stamp_stretch, 399.0 / 400.0);
  // One vehicle: the seven agree to a centimetre, though sections 5 to 7 hardly turn or pitch.
  EXPECT_LT((c.reference_point_m - Vector3d(1.77, -0.01, -0.115)).norm(), 0.02)
      << c.reference_point_m.transpose();
  for (const Conclusion& conclusion : c.conclusions)
    if (!conclusion.runner_up.empty()) {
      EXPECT_GT(conclusion.residual_ratio, 2.0) << toText(conclusion);
    }
  // The DVL's errors are one vehicle's: the sections must agree on them, within what a delay searched in
  // steps of 0.02 s leaves. Sections 5 to 7 hardly turn or pitch.
  EXPECT_NEAR(c.dvl_regression.delay_s, 1.03, 0.06);
  EXPECT_NEAR(c.dvl_regression.lever_arm_m.x(), -0.06, 0.06);
  EXPECT_NEAR(c.dvl_regression.lever_arm_m.y(), 0.03, 0.06);
  EXPECT_NEAR(c.dvl_regression.scale_error, 0.0, 0.006);
  EXPECT_LT(c.dvl_regression.rotation_rad.norm(), radians(0.5));
  EXPECT_LT(c.dvl_regression.residual_m_s.maxCoeff(), 0.02) << "the data sheet's sigma";
}

/// The INS's samples, on the solution's clock.
struct Streams {
  std::vector<double> time_s;
  std::vector<Vector3d> rate, force, velocity_dvl;
};
Streams streams(const ImportedRecording& recording) {
  Streams s;
  for (const Sample& sample : recording.samples) {
    if (const auto* ins = std::get_if<InsSample>(&sample.reading)) {
      s.time_s.push_back(secondsBetween(recording.start, sample.time));
      s.rate.push_back(*ins->angular_velocity_ins);
      s.force.push_back(*ins->specific_force_ins);
    } else {
      s.velocity_dvl.push_back(*std::get<DvlSample>(sample.reading).velocity_dvl);
    }
  }
  return s;
}

/// Mean of the samples in [from, to).
Vector3d mean(const Streams& s, const std::vector<Vector3d>& values, double from, double to) {
  Vector3d sum = Vector3d::Zero();
  double count = 0;
  const auto first = std::lower_bound(s.time_s.begin(), s.time_s.end(), from);
  for (auto k = static_cast<std::size_t>(first - s.time_s.begin()); k < values.size() && s.time_s[k] < to;
       ++k)
    sum += values[k], ++count;
  return sum / count;
}

/// Recomputed from the imported samples and the reference alone: gravity points down, and the gyro turns the
/// attitude.
TEST_P(Akit, ImportedInsAgreesWithTheReference) {
  const auto recording = importSeaTrial(files(), {.undo_stamp_stretch = true});
  const Streams s = streams(recording);
  const auto& reference = recording.reference;
  Vector3d gravity = Vector3d::Zero();
  double turned_wrong = 0.0, turned = 0.0;
  double count = 0;
  for (std::size_t k = 2; k + 2 < reference.size(); ++k) {
    const double t = secondsBetween(recording.start, reference[k].time);
    const Matrix3d& R = reference[k].T_odom_robot.rotation;
    const Vector3d truth = logSO3<double>(R.transpose() * reference[k + 1].T_odom_robot.rotation);
    turned_wrong += (mean(s, s.rate, t, t + 1.0) - truth).squaredNorm();
    turned += truth.squaredNorm();
    gravity += R * mean(s, s.force, t - 0.5, t + 0.5);
    ++count;
  }
  gravity /= count;
  // Normal gravity; over 400 s the mean acceleration is below 2 * 2 m/s / 400 s = 0.01, accelerometer bias
  // comes on top.
  EXPECT_NEAR(gravity.z(), 9.7955, 0.01);
  EXPECT_LT(gravity.head<2>().norm(), 0.02);
  // Of the angle turned, what is left is Earth's rotation (7e-5 rad) and the sampling.
  EXPECT_LT(std::sqrt(turned_wrong / turned), 0.03);
  std::cout << "gravity " << gravity.transpose() << " m/s2; angle error " << std::sqrt(turned_wrong / count)
            << " rad a second of " << std::sqrt(turned / count) << '\n';
}

/// The sections are 400 s, 660 to 900 m long. Attitude of the reference, velocity of the DVL, nothing
/// corrected: the lever arm swings the end by up to 2 * 1.9 m, a delay of 1.5 s the path by 1.5 s * 2 m/s at
/// each end.
TEST_P(Akit, DeadReckoningWithTheDvlEndsNearTheReference) {
  const auto recording =
      importSeaTrial(files(), {.undo_stamp_stretch = true, .reference_as_published = true});
  const Streams s = streams(recording);
  const auto& reference = recording.reference;
  ASSERT_EQ(s.velocity_dvl.size(), reference.size());
  Vector3d position = Vector3d::Zero();
  double travelled = 0.0, worst = 0.0;
  for (std::size_t k = 0; k + 1 < reference.size(); ++k) {
    const double dt = secondsBetween(reference[k].time, reference[k + 1].time);
    const Vector3d step = 0.5 * dt *
                          (reference[k].T_odom_robot.rotation * s.velocity_dvl[k] +
                           reference[k + 1].T_odom_robot.rotation * s.velocity_dvl[k + 1]);
    position += step;
    travelled += step.norm();
    worst = std::max(worst, (position - reference[k + 1].T_odom_robot.position).norm());
  }
  const double end = (position - reference.back().T_odom_robot.position).norm();
  std::cout << "dead reckoning over " << travelled << " m: " << end << " m off at the end, " << worst
            << " m at worst\n";
  EXPECT_GT(travelled, 600.0);
  EXPECT_LT(worst, 10.0);
}

TEST_P(Akit, ImportsSamplesReferenceAndVehicle) {
  const auto recording = importSeaTrial(files());
  EXPECT_EQ(recording.samples.size(), 40400U);
  EXPECT_EQ(recording.reference.size(), 400U);
  EXPECT_NEAR(secondsBetween(recording.start, recording.samples.back().time), 400.0, 1e-6);
  EXPECT_TRUE(recording.reference.front().T_odom_robot.position.isZero(1e-6));
  const auto file = test::scratchFolder() / "vehicle.yaml";
  writeTextFile(file, recording.vehicle_yaml);
  const Vehicle vehicle = readVehicle(file);
  ASSERT_TRUE(vehicle.ins && vehicle.dvl && !vehicle.camera && !vehicle.depth);
  EXPECT_NEAR(vehicle.ins->rate_hz, 100, 0.1);
  EXPECT_NEAR(vehicle.dvl->rate_hz, 1, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Sections, Akit, testing::Range(1, kSections + 1));

}  // namespace
}  // namespace fathom
