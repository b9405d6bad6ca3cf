#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "recording/tum.h"

namespace fathom {

struct RecordedPath {
  std::vector<StampedPose> poses;  ///< finite, their times increase
  std::uint64_t left_out = 0;  ///< poses that are not finite, have no time, or are not later than one before
};

/// The poses that a recording has under a label (TRUTH, EKF_TL2, …), or those of TUM text, whatever the
/// label. Empty `label`: the only one with poses. Throws Error where the file cannot be read, has none under
/// the label (none that a path can hold), or has several labels and none is given.
RecordedPath recordedPath(const std::filesystem::path& file, const std::string& label);

}  // namespace fathom
