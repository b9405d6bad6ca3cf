#pragma once

#include <filesystem>

#include "recording/axes.h"
#include "sea_trial/import_sea_trial.h"
#include "sea_trial/sea_trial.h"

/// Sea trials made from a known motion, with conventions broken on purpose.
namespace fathom::test {

/// What may be odd about a published sea trial. Default: everything as one would expect, FRD and NED.
struct Oddities {
  bool columns_swapped = false;
  bool altitude_down = false;
  Vector3d attitude_sign = Vector3d::Ones();
  SignedAxes gyro, accelerometer, dvl;  // columns to FRD, as the importer should conclude
  bool stamps_stretched = false;
  double imu_offset_s = 0.0;
  double dvl_delay_s = 0.0;
  double dvl_scale_error = 0.0;
  Vector3d dvl_lever_arm_robot = Vector3d::Zero();  // from the IMU
  Vector3d reference_point_robot = Vector3d::Zero();
  bool earth_rate = false;
};

inline constexpr double kTrialLatitude = radians(32.85), kTrialLongitude = radians(34.89);
inline constexpr int kTrialRows = 400;  ///< of the DVL and the navigation solution, one a second

/// A submarine's way: turning, diving and rolling gently at 2 m/s. FRD against NED, t in seconds.
namespace sea_trial_motion {
Matrix3d attitude(double t);
Vector3d velocityFrd(double t);
Vector3d velocityNed(double t);
Vector3d rateFrd(double t);
Vector3d specificForceFrd(double t);
}  // namespace sea_trial_motion

SeaTrialData makeSeaTrial(const Oddities& odd, std::uint64_t seed);
/// Section 1 of a folder.
SeaTrialFiles writeSeaTrial(const SeaTrialData& data, const std::filesystem::path& folder);

}  // namespace fathom::test
