#pragma once

#include "sea_trial/sea_trial.h"

/// What the axes, columns and stamps of a sea trial mean, established by consistency between its streams.
namespace fathom {

/// Method: clocks are aligned first, by what no axis convention can change (the angle turned in a row's
/// interval). Then every combination of signs of roll, pitch and yaw is tried, and for each all 48
/// assignments of the gyro's, the accelerometer's and the DVL's axes; the residuals' likelihood decides. What
/// is published stays as it is unless the evidence against it is decisive (kDecisiveRatio).
/// Needs at least 10 rows of DVL and navigation solution; throws std::invalid_argument below
/// that, and where the streams do not overlap in time.
SeaTrialConventions establishConventions(const SeaTrialData& data);

}  // namespace fathom
