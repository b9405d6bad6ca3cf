#pragma once

#include <filesystem>

#include "core/time.h"
#include "dive.h"
#include "sealed_case.h"

namespace fathom::sealed {

/// truth.json (the case, and the seal: each file's SHA-256) and truth.tum (T_odom_robot). Throws Error.
void writeTruth(const std::filesystem::path& folder, const std::filesystem::path& recording,
                const SealedCase& sealed, const Dive& dive, Time start);

}  // namespace fathom::sealed
