#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "localization/options.h"
#include "recording/tum.h"

namespace fathom {

/// Where `--start` says that the path begins: nothing for "auto"; the reference's pose at the recording's
/// first reading (its first TRUTH entry where `reference` is empty) for "reference"; or the numbers
/// X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]. Throws Error.
std::optional<StartPose> startPose(const std::string& start, const std::filesystem::path& rawlog,
                                   const std::vector<StampedPose>& reference);

}  // namespace fathom
