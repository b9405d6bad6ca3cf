#pragma once

#include <vector>

#include "audit/regression.h"
#include "audit/streams.h"
#include "core/geometry.h"

namespace fathom {

/// How a DVL's velocity changes, beside what the INS's gyro and accelerometer make of it where it sits: both
/// turned into the axes that the robot had at the beginning of a segment of some seconds, and without their
/// parabola, in which are gravity, the tilt at the beginning and, where the robot does not turn, the biases.
struct AccelerationEvidence {
  using ByBias = Eigen::Matrix<double, 3, 6>;  ///< of gyro, rad/s, and accelerometer, m/s², robot axes
  struct Change {
    Vector3d by_ins, by_dvl;  ///< m/s, as they read
    ByBias by_bias;           ///< by so much by_dvl - by_ins falls with constant biases
  };
  std::vector<Change> changes;

  /// by_dvl over by_ins, which is freed of biases.
  Regression all(const Eigen::Matrix<double, 6, 1>& bias = Eigen::Matrix<double, 6, 1>::Zero()) const;
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
