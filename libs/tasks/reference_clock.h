#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "recording/tum.h"

namespace fathom {

/// By how much the clock of a reference is off the recording's: at a time t of the recording the robot was
/// where the reference says at t + the offset, s. Found by how far the robot turns in a second, by the gyro
/// and by the reference (an angle, whatever the axes), over the first half minute. Nothing where they agree
/// as they stand, or where too little turning or another reason leaves it open.
std::optional<double> referenceClockOffset(const std::filesystem::path& rawlog,
                                           const std::vector<StampedPose>& reference);

}  // namespace fathom
