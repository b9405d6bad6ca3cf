#include "support/render_scenes.h"

namespace fathom::test {

CameraModel rovCamera() {  // config/rov.yaml
  CameraModel camera;
  camera.fx_px = 555.1962;
  camera.fy_px = 555.2854;
  camera.cx_px = 321.1975;
  camera.cy_px = 244.7355;
  camera.k1 = -0.041737;
  camera.k2 = -0.023008;
  camera.p1 = -0.000173;
  camera.p2 = 0.000823;
  return camera;
}

Surface rectangle(double width, double height, const Eigen::Vector3f& albedo) {
  Surface surface;
  const auto x = static_cast<float>(width / 2), y = static_cast<float>(height / 2);
  for (const auto& [sx, sy] : {std::pair(-1.f, -1.f), {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}})
    surface.vertices.push_back({{sx * x, sy * y, 0}, Eigen::Vector3f::UnitZ(), albedo});
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  return surface;
}

Surface tube(double radius, double length, const Eigen::Vector3f& albedo, std::uint32_t sides) {
  Surface surface;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const auto angle = static_cast<float>(2 * std::numbers::pi * k / sides);
    const Eigen::Vector3f normal(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3f rim = static_cast<float>(radius) * normal;
    surface.vertices.push_back({rim, normal, albedo});
    surface.vertices.push_back({rim + static_cast<float>(length) * Eigen::Vector3f::UnitZ(), normal, albedo});
    const std::uint32_t a = 2 * k, b = 2 * ((k + 1) % sides);
    surface.triangles.push_back({a, b, b + 1});
    surface.triangles.push_back({a, b + 1, a + 1});
  }
  return surface;
}

Surface markerSurface(const std::string& family, int id, double size_m) {
  const MarkerPattern pattern = markerPattern(family, id);
  const double cell_m = size_m / pattern.border_cells;
  Surface surface;
  for (int row = -1; row <= pattern.cells; ++row)
    for (int column = -1; column <= pattern.cells; ++column) {
      const bool inside = row >= 0 && column >= 0 && row < pattern.cells && column < pattern.cells;
      const float albedo = !inside || pattern.whiteAt(row, column) ? 0.85f : 0.04f;
      const double middle = 0.5 * (pattern.cells - 1);
      surface.add(rectangle(cell_m, cell_m, Eigen::Vector3f::Constant(albedo)),
                  {Matrix3d::Identity(), cell_m * Vector3d(column - middle, middle - row, 0)});
    }
  return surface;
}

Surface panelSurface() {
  Surface surface = rectangle(1.6, 1.2, {0.60f, 0.42f, 0.05f});
  int id = 0;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 7; ++column)
      surface.add(markerSurface("DICT_ARUCO_ORIGINAL", id++, 0.12),
                  {Matrix3d::Identity(), Vector3d(-0.66 + 0.22 * column, 0.42 - 0.28 * row, 0.001)});
  for (int k = 0; k < 9; ++k)
    surface.add(tube(0.03, 0.10, {0.5f, 0.05f, 0.04f}, 32),
                {Matrix3d::Identity(), Vector3d(-0.6 + 0.15 * k, 0.0, 0.0)});
  return surface;
}

Pose facingPanel(const Vector3d& position_odom) {
  Matrix3d R_odom_panel;
  R_odom_panel << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  return {R_odom_panel, position_odom};
}

Pose lookingAt(const Vector3d& from_odom, const Vector3d& at_odom) {
  const Vector3d z = (at_odom - from_odom).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Matrix3d R_odom_camera;
  R_odom_camera << x, z.cross(x), z;
  return {R_odom_camera, from_odom};
}

Surface panelOnSeaFloor() {
  Surface surface;
  surface.add(panelSurface(), facingPanel(kPanelPosition_odom));
  SeaFloor floor;
  floor.centre_odom = {6.0, 0.0, -2.0};
  surface.add(seaFloor(floor, Random(1)));
  return surface;
}

Lighting lampsBeside(const Pose& T_odom_camera, float ambient, float irradiance_1m) {
  Lighting lighting;
  lighting.ambient.setConstant(ambient);
  Matrix3d R_camera_lamp;
  R_camera_lamp << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  for (const double side : {-1.0, 1.0}) {
    const Matrix3d inwards = expSO3<double>(Vector3d(0, -0.1 * side, 0));
    const Pose T_camera_lamp{inwards * R_camera_lamp, Vector3d(0.28 * side, -0.1, 0.0)};
    lighting.spots.push_back(
        {T_odom_camera * T_camera_lamp, radians(32), irradiance_1m * Eigen::Vector3f(1.0f, 0.95f, 0.9f)});
  }
  return lighting;
}

}  // namespace fathom::test
