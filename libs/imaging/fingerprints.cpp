#include "imaging/fingerprints.h"

namespace fathom {
namespace {

void add(Fingerprint& fingerprint, const std::vector<Surface::Vertex>& vertices) {
  for (const Surface::Vertex& vertex : vertices)
    for (const Eigen::Vector3f& vector : {vertex.position, vertex.normal, vertex.albedo})
      fingerprint.add(vector.data(), sizeof(float) * 3);
}

}  // namespace

void add(Fingerprint& fingerprint, const Pose& pose) {
  fingerprint.add(pose.rotation.data(), sizeof(double) * 9).add(pose.position.data(), sizeof(double) * 3);
}

void add(Fingerprint& fingerprint, const CameraModel& camera) {
  for (const double number :
       {1.0 * camera.width_px, 1.0 * camera.height_px, camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px,
        camera.k1, camera.k2, camera.p1, camera.p2, camera.k3})
    fingerprint.add(number);
  if (camera.bayer != BayerPattern::none) fingerprint.add(static_cast<double>(camera.bayer));
  if (camera.lens == LensModel::plumb_bob) return;
  for (const double number : {camera.k4, camera.k5, camera.k6}) fingerprint.add(number);
  fingerprint.add(nameOf(camera.lens));
}

std::string fingerprintOf(const CameraModel& camera) {
  Fingerprint fingerprint;
  add(fingerprint, camera);
  return fingerprint.hex();
}

std::string fingerprintOf(const CameraSheet& sheet) {
  Fingerprint fingerprint;
  fingerprint.add(fingerprintOf(sheet.model));
  for (const double number : {sheet.response_gamma, 1.0 * sheet.bits, sheet.full_well_e, sheet.read_noise_e})
    fingerprint.add(number);
  if (sheet.model.above_water) fingerprint.add("above water");
  return fingerprint.hex();
}

std::string fingerprintOf(const std::vector<LampSheet>& lamps) {
  Fingerprint fingerprint;
  for (const LampSheet& lamp : lamps) {
    fingerprint.add(lamp.half_angle_rad);
    add(fingerprint, lamp.T_robot_lamp);
  }
  return fingerprint.hex();
}

std::string fingerprintOf(const Environment& environment) {
  Fingerprint fingerprint;
  for (const Vector3d& colour :
       {environment.water.attenuation_per_m, environment.water.veil, environment.ambient,
        environment.lamps_irradiance_1m.value_or(Vector3d(-1, -1, -1))})
    fingerprint.add(colour.data(), sizeof(double) * 3);
  return fingerprint.hex();
}

std::string fingerprintOf(const Surface& surface) {
  Fingerprint fingerprint;
  add(fingerprint, surface.vertices);
  for (const auto& triangle : surface.triangles) fingerprint.add(triangle.data(), sizeof triangle);
  return fingerprint.hex();
}

std::string fingerprintOf(const PanelMap& map) {
  Fingerprint fingerprint;
  fingerprint.add(formatPanelMap(map));
  add(fingerprint, map.body.vertices);
  return fingerprint.hex();
}

}  // namespace fathom
