#pragma once

#include <filesystem>
#include <vector>

#include "observables/posed_images.h"

namespace fathom {

/// Where images were taken, as COLMAP's text model (colmap.github.io/format.html, "Sparse reconstruction"):
/// cameras.txt, images.txt and points3D.txt in `folder`. World is odom. A pinhole with plumb-bob distortion
/// is COLMAP's FULL_OPENCV; its pixels are counted from the corner of the top left one. Points are the
/// markers' corners, of the map's panels, with where they were found. Images are named by their files.
/// Returns how many images were written. Throws Error where a file cannot be written.
std::size_t exportColmap(const PosedImages& images, const std::vector<PanelMap>& panels,
                         const std::filesystem::path& folder);

}  // namespace fathom
