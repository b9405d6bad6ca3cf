#pragma once

#include <array>
#include <span>

#include "audit/regression.h"
#include "audit/streams.h"

namespace fathom {

/// Seconds, or readings of one second each, below which nothing is said.
inline constexpr std::size_t kFewestSeconds = 8;

/// What an attitude may be by mistake.
struct AttitudeReading {
  const char* name;
  const char* says;
  Matrix3d (*read)(const Matrix3d& attitude, const Matrix3d& R_robot_ins);
};
/// The first is as it stands.
std::span<const AttitudeReading> attitudeReadings();

/// How the attitude turns over the gyro's rate, about each of the INS's axes; rad/s, over a second each.
std::array<Regression, 3> turningByAxis(const InsStream& stream);

}  // namespace fathom
