#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recording/tum.h"

namespace fathom {

/// The poses that a recording has under a label (TRUTH, EKF_TL2, …), or those of TUM text, whatever the
/// label. Empty `label`: the only one with poses. Throws Error where the file cannot be read, has none under
/// the label, or has several labels and none is given.
std::vector<StampedPose> recordedPath(const std::filesystem::path& file, const std::string& label);

}  // namespace fathom
