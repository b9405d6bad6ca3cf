#pragma once

#include <array>
#include <span>

#include "audit/regression.h"
#include "audit/streams.h"
#include "recording/axes.h"

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

/// How an INS's attitude turns, beside its gyro, and where it turns gravity.
class AttitudeEvidence {
 public:
  explicit AttitudeEvidence(const InsStream& stream) : stream_(stream) {}

  /// The attitude's rate, so read, over the gyro's, whose axes have these signs; rad/s. Over half a second;
  /// where an attitude's noise hides the turning then, over two.
  Regression turning(const AttitudeReading& reading = attitudeReadings()[0],
                     const Vector3d& gyro_signs = Vector3d::Ones()) const;
  /// The same over so many windows.
  Regression turning(const AttitudeReading& reading, std::size_t windows, const Vector3d& gyro_signs) const;
  /// The same about each of the INS's axes.
  std::array<Regression, 3> turningByAxis(const AttitudeReading& reading = attitudeReadings()[0]) const;
  /// How the direction of the specific force turns over how the gyro turns what stands still: u' = u x omega
  /// (Farrell 2008, sec. 2.6).
  Regression turningOfGravity() const;

  /// How far off up the attitude, so read, turns the specific force, whose axes are taken for these; rad, NaN
  /// without an attitude.
  double medianTilt(const AttitudeReading& reading, const SignedAxes& force_axes) const;

 private:
  template <class F>
  void forEachTurn(const AttitudeReading& reading, std::size_t step, F&& f) const;

  const InsStream& stream_;
};

}  // namespace fathom
