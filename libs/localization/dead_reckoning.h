#pragma once

#include <vector>

#include "recording/samples.h"
#include "recording/tum.h"

namespace fathom {

/// What a filter is to be compared with: the DVL's velocity summed up from a start pose, turned by
///   - the gyro's rates summed up (plain integration), and
///   - a reference's own attitude, where there is one (what better heading could gain at best).
/// Nominal mountings, no gate, no bias; trapezoidal between DVL readings.
class DeadReckoning {
 public:
  explicit DeadReckoning(const Pose& T_odom_robot_start)
      : start_(T_odom_robot_start), R_odom_robot_(T_odom_robot_start.rotation) {}

  void add(const Sample& sample);

  /// One pose a DVL reading.
  std::vector<StampedPose> plain() const;
  /// Likewise, where the reference covers the time.
  std::vector<StampedPose> byAttitudeOf(const std::vector<StampedPose>& reference) const;

 private:
  struct Reading {
    Time time;
    Vector3d velocity_robot;
    Matrix3d R_odom_robot;  ///< by the gyro
  };
  void turn(const InsSample& ins, const Time& time);

  Pose start_;
  Matrix3d R_odom_robot_;
  std::optional<Time> last_gyro_;
  std::vector<Reading> readings_;
};

}  // namespace fathom
