#pragma once

#include <filesystem>

#include "sealed_case.h"

namespace fathom::sealed {

/// Makes a sealed recording: `out` gets what a user would have, `truth` what is hidden and the seal. Both
/// folders are written aside and renamed when whole. Throws Error, also where either is there already.
void sealRecording(const SealedCase& sealed, const std::filesystem::path& out,
                   const std::filesystem::path& truth);

}  // namespace fathom::sealed
