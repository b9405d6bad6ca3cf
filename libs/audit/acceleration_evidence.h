#pragma once

#include <vector>

#include "audit/regression.h"
#include "audit/streams.h"
#include "core/geometry.h"

namespace fathom {

/// How a DVL's velocity changes, beside what the INS's gyro and accelerometer make of it where it sits: both
/// turned into the axes that the robot had at the beginning of a segment of some seconds, and without their
/// parabola, in which are gravity, the tilt at the beginning and the biases.
struct AccelerationEvidence {
  struct Change {
    Vector3d by_ins, by_dvl;  ///< m/s, as they read
  };
  std::vector<Change> changes;

  /// by_dvl over by_ins.
  Regression all() const;
};

/// What the sensors' entries are taken for, before their mountings: axes times the unit, and when.
struct AssumedAxes {
  Matrix3d gyro = Matrix3d::Identity(), accelerometer = Matrix3d::Identity(), dvl = Matrix3d::Identity();
  double dvl_later_s = 0;
};
/// Of at most kMostSegments, evenly over the recording.
inline constexpr std::size_t kMostSegments = 60;
AccelerationEvidence accelerationEvidence(const DvlStream& dvl, const InsStream& ins,
                                          const AssumedAxes& axes = {});

}  // namespace fathom
