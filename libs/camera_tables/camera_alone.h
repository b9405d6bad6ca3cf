#pragma once

#include <string>

#include "core/camera_model.h"
#include "core/time.h"

namespace fathom {

/// When a recording begins whose source has no time: 2000-01-01.
Time timelessBegin();
/// A vehicle file with nothing aboard but a camera, left of a pair perhaps. `what`: a comment.
std::string cameraAloneYaml(const std::string& what, const CameraModel& camera, double rate_hz,
                            double corner_sigma_px);

}  // namespace fathom
