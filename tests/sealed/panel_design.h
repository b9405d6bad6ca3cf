#pragma once

#include <filesystem>

namespace fathom::sealed {

/// Writes panel.yaml, panel.obj and panel.mtl: a board with twelve markers on white plates, a frame and two
/// legs, standing on a sea floor at z = -6 of odom; with_squares: and coloured squares between the plates.
/// Throws Error.
void writePanel(const std::filesystem::path& folder, bool with_squares);

/// Where its board's middle is, odom.
inline constexpr double kPanelX_m = 6.0, kPanelY_m = 0.0, kPanelZ_m = -4.2;
inline constexpr double kFloorDepth_m = 6.0;
inline constexpr double kHalfWidth_m = 0.85, kHalfHeight_m = 0.55;

}  // namespace fathom::sealed
