// A sea trial made from a known motion, with conventions broken on purpose: the importer must recognise each.
#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "core/files.h"
#include "sea_trial/conventions.h"
#include "sea_trial/import_sea_trial.h"
#include "sea_trial/remarks.h"
#include "sensors/vehicle.h"
#include "support/sea_trials.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

using test::kTrialLatitude;
using test::kTrialRows;
using test::makeSeaTrial;
using test::Oddities;
using test::writeSeaTrial;
using namespace test::sea_trial_motion;

void expectRecovered(const Oddities& odd, std::uint64_t seed) {
  const SeaTrialConventions c = establishConventions(makeSeaTrial(odd, seed));
  EXPECT_EQ(c.position_columns_swapped, odd.columns_swapped);
  EXPECT_EQ(c.altitude_sign, odd.altitude_down ? -1 : 1);
  EXPECT_EQ(c.attitude_sign, odd.attitude_sign) << c.attitude_sign.transpose();
  EXPECT_EQ(c.gyro, odd.gyro) << c.gyro.text() << " instead of " << odd.gyro.text();
  EXPECT_EQ(c.accelerometer, odd.accelerometer) << c.accelerometer.text();
  EXPECT_EQ(c.dvl, odd.dvl) << c.dvl.text() << " instead of " << odd.dvl.text();
  EXPECT_EQ(c.stamp_stretch, odd.stamps_stretched ? (kTrialRows - 1.0) / kTrialRows : 1.0);
  EXPECT_NEAR(c.imu_offset_s, odd.imu_offset_s, 0.01);
}

const SignedAxes kFlippedY{{0, 1, 2}, {1, -1, 1}};

TEST(SeaTrial, WhatIsRightIsLeftAlone) {
  Oddities none;
  expectRecovered(none, 1);
  for (const Conclusion& c : establishConventions(makeSeaTrial(none, 2)).conclusions)
    if (!c.runner_up.empty()) {
      EXPECT_GT(c.residual_ratio, 2.0) << "should be sure: " << toText(c);
    }
}

TEST(SeaTrial, RecognisesEachOddityAlone) {
  Oddities odd;
  odd.columns_swapped = true;
  expectRecovered(odd, 3);
  odd = {};
  odd.altitude_down = true;
  expectRecovered(odd, 4);
  odd = {};
  odd.attitude_sign = {1, -1, 1};
  expectRecovered(odd, 5);
  odd = {};
  odd.gyro = kFlippedY;
  expectRecovered(odd, 6);
  odd = {};
  odd.accelerometer.sign = {-1, -1, -1};  // acceleration of gravity instead of specific force
  expectRecovered(odd, 7);
  odd = {};
  odd.dvl.sign = {1, 1, -1};
  expectRecovered(odd, 8);
  odd = {};
  odd.stamps_stretched = true;
  expectRecovered(odd, 9);
  odd = {};
  odd.imu_offset_s = -0.43;
  expectRecovered(odd, 10);
}

TEST(SeaTrial, RecognisesWhatTheSeaTrialHas) {
  Oddities odd;
  odd.gyro = odd.accelerometer = kFlippedY;
  odd.stamps_stretched = true;
  odd.imu_offset_s = -0.45;
  odd.dvl_delay_s = 1.0;
  odd.dvl_lever_arm_robot = {-0.08, 0.02, -0.2};
  odd.reference_point_robot = {1.77, -0.01, -0.11};
  odd.earth_rate = true;
  expectRecovered(odd, 11);
}

TEST(SeaTrial, ReferenceIsWhereAndWhenTheImuIs) {
  Oddities odd;
  odd.gyro = odd.accelerometer = kFlippedY;
  odd.stamps_stretched = true;
  odd.imu_offset_s = 0.44;
  odd.reference_point_robot = {1.77, -0.3, -0.11};
  const SeaTrialData data = makeSeaTrial(odd, 60);
  const SeaTrialConventions c = establishConventions(data);
  // Its height shows in pitching and rolling only, which is slow here: as much as the millisecond or two to
  // which the reference's clock is found, in which gravity turns along.
  const Vector3d off = c.reference_point_m - odd.reference_point_robot;
  EXPECT_LT(off.head<2>().norm(), 0.03) << off.transpose();
  EXPECT_LT(std::abs(off.z()), 0.2) << off.transpose();
  EXPECT_LT(c.reference_point_sigma_m.head<2>().maxCoeff(), 0.02);

  const auto files = writeSeaTrial(data, test::scratchFolder());
  const auto recording = importSeaTrial(files);
  Vector3d position = Vector3d::Zero();
  for (std::size_t k = 0; k < recording.reference.size(); ++k) {
    const StampedPose& pose = recording.reference[k];
    const double t = static_cast<double>(k) + odd.imu_offset_s;
    EXPECT_NEAR(secondsBetween(recording.start, pose.time), t, 0.01);
    EXPECT_LT((pose.T_odom_robot.position - position).norm(), 0.1) << "the Earth is flat to 5 cm here";
    for (int i = 0; i < 100; ++i) position += 0.01 * (swapNedEnu() * velocityNed(t + 0.01 * i + 0.005));
  }
  const auto as_published = importSeaTrial(files, {.reference_as_published = true});
  EXPECT_NEAR(secondsBetween(as_published.start, as_published.reference.back().time), 400.0, 1e-6);
}

/// Straight ahead nothing tells where the solution's point is, and nothing is moved.
TEST(SeaTrial, LeavesThePointWhereNothingTellsIt) {
  const SeaTrialData turning = makeSeaTrial({}, 61);
  SeaTrialData data = turning;
  Random random(62);
  for (std::size_t k = 0; k < data.imu_time_s.size(); ++k) {
    data.rate_imu[k] = 5e-4 * random.normal3();
    data.acceleration_imu[k] = Vector3d(0, 0, -9.7955) + 0.02 * random.normal3();
  }
  for (std::size_t k = 0; k < data.gt_time_s.size(); ++k) {
    data.velocity_ned[k] = Vector3d(2, 0, 0);
    data.roll_pitch_yaw[k].setZero();
  }
  SeaTrialConventions c;
  settleReferencePoint(AlignedStreams(data, c), c);
  EXPECT_TRUE(c.reference_point_m.isZero());
  EXPECT_TRUE(c.conclusions.back().concluded.starts_with("taken for the IMU"))
      << toText(c.conclusions.back());
}

TEST(SeaTrial, RecognisesAnyCombination) {
  const auto all_axes = AxesEvidence{}.ranking();
  Random random(12);
  const auto pick = [&] { return all_axes[static_cast<std::size_t>(random.uniform(0, 48))].axes; };
  const auto sign = [&] { return random.uniform() < 0.5 ? -1.0 : 1.0; };
  for (int trial = 0; trial < 6; ++trial) {
    Oddities odd;
    odd.columns_swapped = sign() > 0;
    odd.altitude_down = sign() > 0;
    odd.attitude_sign = {sign(), sign(), sign()};
    odd.gyro = pick();
    odd.accelerometer = pick();
    odd.dvl = pick();
    odd.stamps_stretched = sign() > 0;
    odd.imu_offset_s = random.uniform(-0.6, 0.6);
    odd.dvl_delay_s = random.uniform(-1, 1);
    SCOPED_TRACE("trial " + std::to_string(trial));
    expectRecovered(odd, 100 + static_cast<std::uint64_t>(trial));
  }
}

TEST(SeaTrial, ReportsTheDvlsErrorsWithoutCorrectingThem) {
  Oddities odd;
  odd.dvl_delay_s = 0.6;
  odd.dvl_scale_error = 0.01;
  odd.dvl_lever_arm_robot = {-1.5, 0.2, 0.1};
  odd.earth_rate = true;
  const SeaTrialData data = makeSeaTrial(odd, 20);
  const SeaTrialConventions c = establishConventions(data);
  const DvlRegression& r = c.dvl_regression;
  // The delay is searched in steps of 0.02 s; what is left of it, and straight lines between rows a second
  // apart, bias the rest by about 1 % of the signal, hence more than the fit's own sigmas.
  EXPECT_NEAR(r.delay_s, 0.6, 0.05);
  EXPECT_NEAR(r.scale_error, 0.01, 0.003);
  EXPECT_LT((r.lever_arm_m - odd.dvl_lever_arm_robot).norm(), 0.2) << r.lever_arm_m.transpose();
  EXPECT_LT(r.rotation_rad.norm(), radians(1.0));
  EXPECT_LT(r.residual_m_s.norm(), 0.03);
  EXPECT_GT(r.residual_before_m_s.y(), 0.05);

  const auto recording = importSeaTrial(writeSeaTrial(data, test::scratchFolder()));
  std::size_t row = 0;
  for (const Sample& sample : recording.samples)
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading)) {
      EXPECT_TRUE(dvl->velocity_dvl->isApprox(flipFrdRobot() * data.velocity_dvl[row++], 1e-12));
      EXPECT_TRUE(dvl->T_robot_dvl.position.isZero());
    }
  EXPECT_EQ(row, static_cast<std::size_t>(kTrialRows));
}

TEST(SeaTrial, FindsEarthsRotationOnlyWhereItIs) {
  for (const bool contained : {false, true}) {
    Oddities odd;
    odd.earth_rate = contained;
    const SeaTrialConventions c = establishConventions(makeSeaTrial(odd, 30));
    const Conclusion& last = c.conclusions.back();
    EXPECT_EQ(last.what, "Earth's rotation in the gyro");
    EXPECT_EQ(last.concluded.starts_with("contained"), contained) << toText(last);
  }
}

TEST(SeaTrial, ImportedSamplesAndReferenceFollowTheConvention) {
  Oddities odd;
  odd.columns_swapped = true;
  odd.altitude_down = true;
  odd.attitude_sign = {1, -1, 1};
  odd.gyro = odd.accelerometer = kFlippedY;
  odd.dvl.sign = {1, 1, -1};
  const auto folder = test::scratchFolder();
  const auto recording = importSeaTrial(writeSeaTrial(makeSeaTrial(odd, 40), folder));

  EXPECT_EQ(recording.start, fromUnixSeconds(1654041600.0));
  ASSERT_EQ(recording.samples.size(), 101U * kTrialRows);
  ASSERT_EQ(recording.reference.size(), static_cast<std::size_t>(kTrialRows));
  Time last = recording.start;
  for (const Sample& sample : recording.samples) {
    EXPECT_GE(sample.time, last);
    last = sample.time;
    const double t = secondsBetween(recording.start, sample.time);
    if (const auto* ins = std::get_if<InsSample>(&sample.reading)) {
      EXPECT_LT((*ins->angular_velocity_ins - flipFrdRobot() * rateFrd(t)).norm(), 6 * 5e-4);
      EXPECT_LT((*ins->specific_force_ins - flipFrdRobot() * specificForceFrd(t)).norm(), 6 * 0.02);
    } else {
      const auto& dvl = std::get<DvlSample>(sample.reading);
      EXPECT_LT((*dvl.velocity_dvl - flipFrdRobot() * velocityFrd(t)).norm(), 6 * 0.01);
    }
  }
  // Reference: starts at the origin; its positions are the integral of its own attitude times the velocity.
  Vector3d position = Vector3d::Zero();
  for (std::size_t k = 0; k + 1 < recording.reference.size(); ++k) {
    const Pose& pose = recording.reference[k].T_odom_robot;
    EXPECT_NEAR(pose.rotation.determinant(), 1.0, 1e-9);
    EXPECT_LT((pose.position - position).norm(), 0.05) << "the Earth is flat to 5 cm here";
    for (int i = 0; i < 100; ++i) {
      const double t = static_cast<double>(k) + 0.01 * i + 0.005;
      position += 0.01 * (swapNedEnu() * attitude(t) * velocityFrd(t));
    }
    const Vector3d heading = pose.rotation.col(0);
    const Vector3d expected = swapNedEnu() * attitude(static_cast<double>(k)).col(0);
    EXPECT_LT((heading - expected).norm(), 1e-9);
    EXPECT_GT(pose.rotation(2, 2), 0.9) << "z is up";
  }
  writeTextFile(folder / "vehicle.yaml", recording.vehicle_yaml);
  const Vehicle vehicle = readVehicle(folder / "vehicle.yaml");
  EXPECT_NEAR(vehicle.ins->gyro_sigma_rad_s, 5e-4, 0.3e-4);
  EXPECT_NEAR(vehicle.ins->accelerometer_sigma_m_s2, 0.02, 0.001);
  EXPECT_NEAR(vehicle.gravity_m_s2, 9.7955, 1e-3);
  EXPECT_EQ(vehicle.dvl->velocity_sigma_xy_m_s, 0.02);
}

TEST(SeaTrial, CanUndoTheStretchOfStamps) {
  Oddities odd;
  odd.stamps_stretched = true;
  const auto files = writeSeaTrial(makeSeaTrial(odd, 50), test::scratchFolder());
  const auto as_published = importSeaTrial(files, {.reference_as_published = true});
  const auto undone = importSeaTrial(files, {.undo_stamp_stretch = true, .reference_as_published = true});
  EXPECT_NEAR(secondsBetween(as_published.start, as_published.reference.back().time), 400.0, 1e-6);
  EXPECT_NEAR(secondsBetween(undone.start, undone.reference.back().time), 399.0, 1e-6);
  // The import says which it is, and the vehicle file's rate is that of the recording.
  for (const auto& [imported, said, rate] :
       {std::tuple(&as_published, "kept as published", "rate_hz: 0.9975"),
        std::tuple(&undone, "undone", "rate_hz: 1\n")}) {
    EXPECT_TRUE(imported->conclusions.back().concluded.starts_with(said))
        << imported->conclusions.back().concluded;
    const std::string& yaml = imported->vehicle_yaml;
    EXPECT_NE(yaml.find(rate, yaml.find("\ndvl:")), std::string::npos) << yaml;
  }
}

TEST(SeaTrial, RefusesWhatProvesNothing) {
  SeaTrialData data = makeSeaTrial({}, 60);
  for (double& t : data.imu_time_s) t += 1000.0;
  EXPECT_THROW(establishConventions(data), std::invalid_argument) << "IMU elsewhere in time";
  data = makeSeaTrial({}, 60);
  for (double& t : data.dvl_time_s) t += 1000.0;
  EXPECT_THROW(establishConventions(data), std::invalid_argument) << "DVL elsewhere in time";

  data = makeSeaTrial({}, 60);
  data.gt_time_s.resize(9);
  EXPECT_THROW(establishConventions(data), std::invalid_argument);
  EXPECT_THROW(importSeaTrial(writeSeaTrial(data, test::scratchFolder())), Error) << "with the file's name";
  EXPECT_THROW(seaTrialFiles(test::scratchFolder(), 1), Error);
}

TEST(SeaTrial, WhatTheColumnsSayIsHeld) {
  SeaTrialData data = makeSeaTrial({}, 62);
  for (double& latitude : data.latitude_rad) latitude = degrees(latitude);
  try {
    importSeaTrial(writeSeaTrial(data, test::scratchFolder()));
    ADD_FAILURE() << "accepted";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("line 2: Latitude [rad] is 32.85"), std::string::npos) << e.what();
  }
}

TEST(SeaTrial, RowsWithoutBottomLockAreLeftOutAndCounted) {
  SeaTrialData data = makeSeaTrial({}, 63);
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  for (int k = 100; k < 110; ++k) data.velocity_dvl[k] = Vector3d(kNan, kNan, kNan);
  for (int k = 200; k < 205; ++k) data.velocity_dvl[k] = Vector3d(-32768, -32768, -32768);
  const auto recording = importSeaTrial(writeSeaTrial(data, test::scratchFolder()));
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_NE(recording.remarks[0].find("15 of 400 rows have no bottom lock"), std::string::npos)
      << recording.remarks[0];
}

TEST(SeaTrial, ADvlInKnotsIsRemarked) {
  SeaTrialData data = makeSeaTrial({}, 64);
  for (Vector3d& velocity : data.velocity_dvl) velocity /= 0.514444;
  const auto recording = importSeaTrial(writeSeaTrial(data, test::scratchFolder()));
  ASSERT_EQ(recording.remarks.size(), 1U);
  EXPECT_NE(recording.remarks[0].find("--correct dvl-in-knots"), std::string::npos) << recording.remarks[0];
}

/// What an import with the corrections says; without, what it says of the tables as they are.
ImportedRecording importCorrected(const SeaTrialData& data,
                                  const std::vector<std::string>& corrections = {}) {
  return importSeaTrial(writeSeaTrial(data, test::scratchFolder()),
                        {.corrections = correctionsNamed(corrections)});
}

void expectSameReference(const ImportedRecording& recording, const ImportedRecording& right) {
  EXPECT_TRUE(recording.remarks.empty()) << recording.remarks[0];
  ASSERT_EQ(recording.reference.size(), right.reference.size());
  for (std::size_t k = 0; k < right.reference.size(); ++k) {
    const StampedPose &pose = recording.reference[k], &expected = right.reference[k];
    EXPECT_NEAR(secondsBetween(expected.time, pose.time), 0, 1e-6);
    EXPECT_LT((pose.T_odom_robot.position - expected.T_odom_robot.position).norm(), 1e-6);
  }
}

// A gyro in degrees turns the clocks and the axes that are found by it.
TEST(SeaTrial, ConcludesFromWhatIsCorrected) {
  Oddities odd;
  odd.gyro = odd.accelerometer = {{1, 0, 2}, {1, 1, -1}};
  odd.imu_offset_s = 0.4;
  odd.reference_point_robot = {1.77, -0.3, -0.11};
  const SeaTrialData right = makeSeaTrial(odd, 65);
  for (const auto& [name, unit] :
       {std::pair("gyro-in-degrees", degrees(1.0)), std::pair("gyro-in-rpm", 30 / std::numbers::pi)}) {
    SeaTrialData data = right;
    for (Vector3d& rate : data.rate_imu) rate *= unit;
    expectSameReference(importCorrected(data, {name}), importCorrected(right));

    // Not corrected, it tells nothing, and no clock is set by it; its axes are the accelerometer's.
    const SeaTrialConventions c = establishConventions(data);
    EXPECT_EQ(c.imu_offset_s, 0.0);
    EXPECT_EQ(c.gyro, odd.gyro) << c.gyro.text();
    ASSERT_EQ(c.doubts.size(), 2U);
    EXPECT_TRUE(c.doubts[0].starts_with("time alignment of navigation solution and IMU: not told"))
        << c.doubts[0];
    EXPECT_TRUE(c.doubts[1].starts_with("gyro axes: not told")) << c.doubts[1];
  }
}

TEST(SeaTrial, ACorrectedDvlIsNotRemarkedAgain) {
  const SeaTrialData right = makeSeaTrial({}, 66);
  for (const auto& [name, unit] :
       {std::pair("dvl-in-millimetres", 1e3), std::pair("dvl-in-knots", 3600.0 / 1852)}) {
    SeaTrialData data = right;
    for (Vector3d& velocity : data.velocity_dvl) velocity *= unit;
    std::string said;
    for (const std::string& remark : importCorrected(data).remarks) said += remark + "\n";
    EXPECT_NE(said.find(std::string("--correct ") + name), std::string::npos) << said;
    EXPECT_LT(degrees(establishConventions(data).dvl_regression.rotation_rad.norm()), 1) << "in any unit";
    expectSameReference(importCorrected(data, {name}), importCorrected(right));
  }
}

TEST(SeaTrial, ADvlThatIsTurnedIsTurnedBack) {
  SeaTrialData data = makeSeaTrial({}, 67);
  for (Vector3d& velocity : data.velocity_dvl)
    velocity = rotationFromYawPitchRoll(radians(30), 0, 0) * velocity;  // about down
  const auto remarks = importCorrected(data).remarks;
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("--correct dvl-turned:30."), std::string::npos) << remarks[0];
  const DvlRegression fit = establishConventions(data).dvl_regression;
  EXPECT_NEAR(fit.scale_error, 0, 0.01);
  EXPECT_NEAR(degrees(fit.rotation_rad.z()), 30, 0.5);
  EXPECT_TRUE(importCorrected(data, {"dvl-turned:30"}).remarks.empty());
}

// Straight ahead, or at rest, much is not told, and nothing is wrong.
TEST(SeaTrial, ADullMotionIsNoReasonForRemarks) {
  for (const double speed_m_s : {0.0, 2.0}) {
    SeaTrialData data = makeSeaTrial({}, 69);
    Random random(70);
    for (std::size_t k = 0; k < data.imu_time_s.size(); ++k) {
      data.rate_imu[k] = 5e-4 * random.normal3();
      data.acceleration_imu[k] = Vector3d(0, 0, -9.7955) + 0.02 * random.normal3();
    }
    for (std::size_t k = 0; k < data.gt_time_s.size(); ++k) {
      data.velocity_ned[k] = Vector3d(speed_m_s, 0, 0);
      data.latitude_rad[k] = kTrialLatitude + static_cast<double>(k) * speed_m_s / 6.36e6;
      data.longitude_rad[k] = test::kTrialLongitude;
      data.altitude_m[k] = -20;
      data.roll_pitch_yaw[k].setZero();
      data.velocity_dvl[k] = data.velocity_ned[k] + 0.01 * random.normal3();
    }
    for (const std::string& remark : importCorrected(data).remarks) ADD_FAILURE() << remark;
    EXPECT_EQ(establishConventions(data).imu_offset_s, 0.0);
  }
}

// What is changed by hardly more than there is for another change.
TEST(SeaTrial, AHeadingFromEastIsDoubted) {
  SeaTrialData data = makeSeaTrial({}, 71);
  for (Vector3d& angles : data.roll_pitch_yaw) angles.z() = radians(90.0) - angles.z();
  EXPECT_FALSE(establishConventions(data).doubts.empty());
}

TEST(SeaTrial, ADvlsClearDelayIsOfferedForCorrection) {
  SeaTrialData data = makeSeaTrial({}, 68);
  for (double& t : data.dvl_time_s) t += 0.8;
  const auto remarks = importCorrected(data).remarks;
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("--correct clock-offset:DVL:-0.8"), std::string::npos) << remarks[0];
  expectSameReference(importCorrected(data, {"clock-offset:DVL:-0.8"}),
                      importCorrected(makeSeaTrial({}, 68)));
}

}  // namespace
}  // namespace fathom
