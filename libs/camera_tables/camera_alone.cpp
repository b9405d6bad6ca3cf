#include "camera_tables/camera_alone.h"

#include "core/text.h"
#include "recording/imported.h"

namespace fathom {

Time timelessBegin() { return fromUnixSeconds(946684800); }

std::string cameraAloneYaml(const std::string& what, const CameraModel& camera, double rate_hz,
                            double corner_sigma_px) {
  return "# " + what + "\ngravity_m_s2: 9.80665\ncamera:\n" + print("  rate_hz: %.9g\n", rate_hz) +
         cameraLines(camera, corner_sigma_px) + (camera.above_water ? "  above_water: true\n" : "") +
         "  pose: " + yamlPose(Pose{}) + "\n";
}

}  // namespace fathom
