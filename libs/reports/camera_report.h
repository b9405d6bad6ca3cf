#pragma once

#include <filesystem>
#include <string>

#include "calibration/camera_selection.h"
#include "report/run_info.h"
#include "report/table.h"

namespace fathom {

/// `fathom calibrate camera`, told.
struct CameraStory {
  RunInfo run;
  std::size_t views_in_air = 0, views_in_water = 0;
  CameraSelection selection;
};

/// A row each kind: what it leaves on views that were not fitted.
Table kindTable(const CameraStory& story);
/// The chosen camera's numbers, beside OpenCV's where both have them.
Table cameraTable(const CameraStory& story);
/// A calibration as ROS's camera_info has it, which other programs read too (readCameraFile()).
std::string cameraInfoYaml(const CameraModel& camera, const std::string& name);
/// folder/camera.yaml, calibration.yaml (a port as an effect) where there is one, result.json, report.html.
/// Throws Error.
void writeCameraStory(const CameraStory& story, const std::filesystem::path& folder);

}  // namespace fathom
