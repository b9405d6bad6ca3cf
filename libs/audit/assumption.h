#pragma once

#include <string>
#include <vector>

#include "audit/attitude_evidence.h"

namespace fathom {

/// What the entries of an INS, a DVL and a pressure sensor are taken for, before their mountings: as they
/// stand, or with a fault of drivers taken out of them.
struct Assumption {
  Matrix3d gyro = Matrix3d::Identity(), accelerometer = Matrix3d::Identity(),
           dvl = Matrix3d::Identity();            ///< axes, times the unit
  Matrix3d attitude_axes = Matrix3d::Identity();  ///< turned as the INS's
  const AttitudeReading* attitude = &attitudeReadings()[0];
  double dvl_later_s = 0, ins_later_s = 0;  ///< their readings are of so much later than they say
  double rise = 1;                          ///< -1: the pressure falls where it should rise
};

/// A fault of drivers that one would see in how streams disagree.
struct DriverFault {
  /// One correction; or two, where a driver makes both at once (all axes, and the attitude's world).
  struct Part {
    std::string correction;  ///< as --correct takes it; its name, before a colon, is the finding's
    std::string says, corrected;
  };
  std::vector<Part> parts;
  Assumption taken_for;
  /// How unusual it is: minus the logarithm of its prior odds against none, up to a constant. What is more
  /// usual is named where the streams do not tell.
  double unusual = 0;
};

/// All that are tried; those of what the recording lacks are left out, and attitudes that mean the same with
/// an INS so mounted.
std::vector<DriverFault> driverFaults(bool has_attitude, bool has_dvl, bool has_depth,
                                      const Matrix3d& R_robot_ins);

}  // namespace fathom
