#include "recording/imported.h"

#include <cstdio>

#include "core/text.h"

namespace fathom {

std::string toText(const Conclusion& conclusion) {
  std::string text = conclusion.what + ": " + conclusion.concluded;
  if (!conclusion.runner_up.empty()) {
    char ratio[32];
    std::snprintf(ratio, sizeof ratio, "%.3g", conclusion.residual_ratio);
    text += " (residual ratio " + std::string(ratio) + " against: " + conclusion.runner_up + ")";
  }
  return conclusion.evidence.empty() ? text : text + "; " + conclusion.evidence;
}

std::string yamlPose(const Pose& pose) {
  const Vector3d& p = pose.position;
  const Vector3d ypr = yawPitchRollFromRotation(pose.rotation);
  return print("{x: %.9g, y: %.9g, z: %.9g, yaw_deg: %.9g, pitch_deg: %.9g, roll_deg: %.9g}", p.x(), p.y(),
               p.z(), degrees(ypr[0]) + 0.0, degrees(ypr[1]) + 0.0,
               degrees(ypr[2]) + 0.0);  // + 0.0: no negative zero
}

std::string cameraLines(const CameraModel& c, double corner_sigma_px, int bits) {
  return print(
      "  width_px: %d\n  height_px: %d\n  fx_px: %.9g\n  fy_px: %.9g\n  cx_px: %.9g\n  cy_px: %.9g\n"
      "  distortion: {%s}\n"
      "  corner_sigma_px: %.9g\n"
      "  # From here on generic: the source does not say.\n"
      "  exposure_s: 0.004\n  gain: fixed\n  response_gamma: 1.0\n  bits: %d\n"
      "  full_well_e: 30000\n  read_noise_e: 12\n",
      c.width_px, c.height_px, c.fx_px, c.fy_px, c.cx_px, c.cy_px, distortionText(c).c_str(), corner_sigma_px,
      bits);
}

}  // namespace fathom
