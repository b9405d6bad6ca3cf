#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recording/axes.h"
#include "sea_trial/aligned_streams.h"

/// Which way the axes of a sea trial's sensors point, and the signs of its attitude.
namespace fathom {

/// What follows from one choice of the signs of roll, pitch and yaw.
struct AttitudeHypothesis {
  Vector3d sign;  ///< of the columns roll, pitch, yaw
  /// AxesEvidence::ranking() of each sensor.
  std::vector<AxesScore> gyro, accelerometer, dvl;
  std::size_t gyro_rows = 0, accelerometer_rows = 0, dvl_rows = 0;
  /// The attitude's rate over what the gyro's leaves of it, RMS: about 1 or less where it fits in no axes.
  double gyro_told = 0.0;
  /// Not where the vehicle just turns too little.
  bool gyroContradicts() const;
  double log_likelihood() const {
    return gyro[0].log_likelihood + accelerometer[0].log_likelihood + dvl[0].log_likelihood;
  }
};

/// All eight, the likeliest first; the published one, if the evidence against it is not decisive.
std::vector<AttitudeHypothesis> rankAttitudes(const AlignedStreams& s);

/// Takes the first.
void settleAttitude(const std::vector<AttitudeHypothesis>& ranked, SeaTrialConventions& c);

/// A sensor's axes, columns to FRD: the best of the ranked, or those published. what, compared, unit: for the
/// conclusion that is added.
SignedAxes settleAxes(const std::string& what, const std::vector<AxesScore>& ranked, std::size_t rows,
                      const std::string& compared, const std::string& unit, SeaTrialConventions& c);

/// The gyro's, likewise; once the accelerometer's are settled, which are the IMU's where the gyro contradicts
/// the attitude in all.
void settleGyro(const AttitudeHypothesis& best, SeaTrialConventions& c);

/// Whether gyro and accelerometer, both settled, have the same axes.
void concludeImuFrame(SeaTrialConventions& c);

}  // namespace fathom
