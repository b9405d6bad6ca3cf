#include "evaluation/input_fingerprints.h"

#include "core/fingerprint.h"

namespace fathom {

std::string fingerprintOf(const CameraModel& camera) {
  Fingerprint fingerprint;
  for (const double number :
       {1.0 * camera.width_px, 1.0 * camera.height_px, camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px,
        camera.k1, camera.k2, camera.p1, camera.p2, camera.k3})
    fingerprint.add(number);
  return fingerprint.hex();
}

std::string fingerprintOf(const CameraSheet& sheet) {
  Fingerprint fingerprint;
  fingerprint.add(fingerprintOf(sheet.model));
  for (const double number : {sheet.response_gamma, 1.0 * sheet.bits, sheet.full_well_e, sheet.read_noise_e})
    fingerprint.add(number);
  return fingerprint.hex();
}

std::string fingerprintOf(const PanelMap& map) {
  Fingerprint fingerprint;
  fingerprint.add(formatPanelMap(map));
  for (const Surface::Vertex& vertex : map.body.vertices)
    for (const Eigen::Vector3f& vector : {vertex.position, vertex.normal, vertex.albedo})
      fingerprint.add(vector.data(), sizeof(float) * 3);
  return fingerprint.hex();
}

}  // namespace fathom
