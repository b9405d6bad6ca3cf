#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "calibration/camera_fit.h"
#include "core/camera_model.h"
#include "panel/panel_map.h"
#include "sensors/vehicle.h"

namespace fathom {

/// What a recording shows of its own panels: the corners of their markers, to calibrate the camera from.
struct PanelViews {
  CameraModel nominal;           ///< as the recording has it
  std::vector<BoardView> views;  ///< one for each image and panel, with the panel's points
  std::size_t images = 0;        ///< that were looked at
};

/// Of the first camera (of a pair the left one), at most so many images, evenly spread. Views of fewer than
/// two markers are left out: their pose alone takes six of eight numbers. Throws Error: the recording cannot
/// be read, or has no images; Interrupted.
PanelViews panelViews(const std::filesystem::path& rawlog, const Vehicle& vehicle,
                      const std::vector<PanelMap>& panels, bool in_water, std::size_t most_images);

}  // namespace fathom
