#pragma once

#include "sea_trial/sampled_signal.h"
#include "sea_trial/sea_trial.h"

namespace fathom {

/// How the stamps of a sea trial's navigation solution lie on the IMU's clock, by the angle turned between
/// its rows, which no axis convention changes. turned_imu: integral of the gyro's rate, rad. Throws
/// std::invalid_argument where the two hardly overlap.
void settleClocks(const SeaTrialData& data, const SampledSignal& turned_imu, SeaTrialConventions& c);

}  // namespace fathom
