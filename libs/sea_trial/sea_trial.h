#pragma once

#include <vector>

#include "recording/axes.h"
#include "recording/imported.h"

/// A sea trial's tables, and what their axes, columns and stamps mean.
/// Frames here: ned (north, east, down) and frd (the vehicle's forward, right, down).
namespace fathom {

/// The three tables as published. imu and dvl: unknown body axes, taken as FRD until shown otherwise.
struct SeaTrialData {
  std::vector<double> imu_time_s;
  std::vector<Vector3d> acceleration_imu;  ///< m/s²
  std::vector<Vector3d> rate_imu;          ///< rad/s
  std::vector<double> dvl_time_s;
  std::vector<Vector3d> velocity_dvl;  ///< m/s
  std::size_t without_lock = 0;        ///< rows of the DVL that are left out
  std::vector<double> gt_time_s;
  std::vector<double> longitude_rad, latitude_rad, altitude_m;  ///< by the columns' names
  std::vector<Vector3d> velocity_ned;                           ///< m/s
  std::vector<Vector3d> roll_pitch_yaw;                         ///< rad
};

/// Fit of what the DVL should read, (1 + scale_error) Exp(-rotation) (v + omega x lever_arm), robot frame (x
/// forward, y left, z up), to what it reads. Information only: nothing of it is corrected.
struct DvlRegression {
  double delay_s = 0.0;  ///< a reading stamped t is valid at t + delay on the IMU's clock
  double scale_error = 0.0, scale_error_sigma = 0.0;
  Vector3d rotation_rad = Vector3d::Zero(), rotation_sigma_rad = Vector3d::Zero();
  /// From the IMU.
  Vector3d lever_arm_m = Vector3d::Zero(), lever_arm_sigma_m = Vector3d::Zero();
  Vector3d residual_before_m_s = Vector3d::Zero();  ///< RMS of each axis, delay only
  Vector3d residual_m_s = Vector3d::Zero();
  double residual_undelayed_m_s = 0.0;  ///< RMS length with all but the delay

  /// Zero of what the motion does not tell.
  double toldScaleError() const;
  Vector3d toldRotation() const;

  /// Whether it explains more than noise would let it.
  bool explainsMore() const;
  /// Whether it explains most of what was off.
  bool fits() const;
  /// Whether there clearly is a delay: not one at the edge of those tried.
  bool isDelayed() const;
};

/// See establishConventions().
struct SeaTrialConventions {
  bool position_columns_swapped = false;
  int altitude_sign = 1;  ///< -1: the column is a depth
  /// True spacing over stamped spacing of the DVL's and the navigation solution's rows: 1, or (N-1)/N where
  /// N rows of N equal steps were stamped as if they filled the whole section from end to end.
  double stamp_stretch = 1.0;
  Vector3d attitude_sign = Vector3d::Ones();  ///< of the columns roll, pitch, yaw
  SignedAxes gyro, accelerometer, dvl;        ///< columns to FRD
  /// A row of the navigation solution stamped t (after the stretch is undone) fits the IMU at t + offset.
  /// Zero where the gyro does not tell it.
  double imu_offset_s = 0.0;
  /// Where the point is whose position and velocity the navigation solution states: from the IMU, robot axes.
  /// Zero where the vehicle turns too little to tell.
  Vector3d reference_point_m = Vector3d::Zero(), reference_point_sigma_m = Vector3d::Zero();
  Vector3d accelerometer_bias_m_s2 = Vector3d::Zero();  ///< found beside it, robot axes
  DvlRegression dvl_regression;
  /// Gyro minus the navigation solution's rate, NED, rad/s: Earth's rotation, where the gyro is not
  /// compensated for it. Median over the section.
  Vector3d rate_excess_ned = Vector3d::Zero();
  std::vector<Conclusion> conclusions;
  /// What of attitude, axes and clocks was changed by hardly more evidence than there is for another answer,
  /// or is contradicted; a line each.
  std::vector<std::string> doubts;
};

/// Position of each row, metres east, north, up of the first row, on WGS-84, with the columns as concluded.
std::vector<Vector3d> positionsEnu(const SeaTrialData& data, bool columns_swapped, int altitude_sign);

/// R_ned_frd of each row.
std::vector<Matrix3d> attitudesNed(const SeaTrialData& data, const Vector3d& attitude_sign);

/// Swaps east and north and flips down: R_enu_ned. Its own inverse.
Matrix3d swapNedEnu();
/// Flips y and z: R_robot_frd, forward-left-up from forward-right-down. Its own inverse.
Matrix3d flipFrdRobot();

}  // namespace fathom
