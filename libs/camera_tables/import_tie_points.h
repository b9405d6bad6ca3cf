#pragma once

#include <cstddef>
#include <filesystem>

#include "camera_tables/watched_window.h"
#include "recording/imported.h"
#include "report/run_info.h"

namespace fathom {

/// What two cameras see of the same points: columns camera (1, the left one, or 2), frame, id, u_px, v_px.
struct TiePointTable {
  std::filesystem::path table;
  std::filesystem::path left, right;  ///< the cameras' files, see readWatchedWindow()
  double sigma_px = 1;                ///< of a coordinate of a point; of a corner, at least
};

struct TiePointImport {
  std::size_t frames = 0, points = 0;
  std::size_t ambiguous = 0;  ///< ids that a camera has twice in a frame: left out
  StereoRig rig;
};

/// Writes a recording of pairs without their images, a vehicle file with the pair, the table of points, and
/// NAME_import.json. Throws Error.
TiePointImport importTiePoints(const TiePointTable& source, const ImportTarget& target, const RunInfo& run);

}  // namespace fathom
