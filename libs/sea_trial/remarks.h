#pragma once

#include "sea_trial/aligned_streams.h"

/// What is said of a sea trial's streams, once axes and clocks are settled.
namespace fathom {

/// Fits the navigation solution's point by the IMU; leaves it where the motion does not tell it.
void settleReferencePoint(const AlignedStreams& s, SeaTrialConventions& c);

/// Fits DvlRegression, at the delay that suits it best.
void reportDvl(const AlignedStreams& s, SeaTrialConventions& c);

/// Whether Earth's rotation is in the gyro's rate.
void reportEarthRate(const AlignedStreams& s, SeaTrialConventions& c);

}  // namespace fathom
