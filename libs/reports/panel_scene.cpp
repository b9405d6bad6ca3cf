#include "reports/panel_scene.h"

#include <mrpt/opengl/CSetOfTriangles.h>
#include <mrpt/opengl/CText3D.h>
#include <mrpt/opengl/stock_objects.h>

#include <cmath>

#include "recording/mrpt_types.h"

namespace fathom {
namespace gl = mrpt::opengl;
namespace {

/// Linear to the screen's 0 to 255 (sRGB, IEC 61966-2-1).
std::uint8_t onScreen(float linear) {
  const float encoded =
      linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(encoded, 0.0f, 1.0f)));
}

gl::CSetOfTriangles::Ptr triangles(const Surface& surface) {
  auto object = gl::CSetOfTriangles::Create();
  object->reserve(surface.triangles.size());
  for (const auto& corners : surface.triangles) {
    gl::TTriangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      const Surface::Vertex& v = surface.vertices[corners[i]];
      auto& target = triangle.vertices[i];
      target.xyzrgba.pt = {v.position.x(), v.position.y(), v.position.z()};
      target.normal = {v.normal.x(), v.normal.y(), v.normal.z()};
      target.setColor(mrpt::img::TColor(onScreen(v.albedo[0]), onScreen(v.albedo[1]), onScreen(v.albedo[2])));
    }
    object->insertTriangle(triangle);
  }
  return object;
}

void addAxes(gl::CSetOfObjects& parent, const Pose& T_parent_frame, double size_m) {
  auto axes = gl::stock_objects::CornerXYZSimple(static_cast<float>(size_m), 2.0f);
  axes->setPose(toMrpt(T_parent_frame));
  parent.insert(axes);
}

/// Letters in the parent's plane of x and y. The viewer hides labels that always face it behind what they
/// name.
void addName(gl::CSetOfObjects& parent, const Vector3d& begin, const std::string& name, double height_m) {
  auto label = gl::CText3D::Create(name, "sans", static_cast<float>(height_m), gl::FILL);
  label->setColor_u8(mrpt::img::TColor(200, 0, 120));
  label->setLocation(begin.x(), begin.y(), begin.z());
  parent.insert(label);
}

gl::CSetOfObjects::Ptr panelObject(const PanelMap& map) {
  auto panel = gl::CSetOfObjects::Create();
  panel->setName("panel " + map.name);
  panel->insert(triangles(surfaceOf(map)));
  addAxes(*panel, {}, 0.2);
  addName(*panel, {0.01, 0.01, 0.2}, "panel", 0.04);
  for (const Marker& marker : map.markers) {
    addAxes(*panel, marker.T_panel_marker, 0.4 * marker.size_m);
    addName(*panel, marker.T_panel_marker.position + Vector3d(0.01, 0.01, 0.4 * marker.size_m),
            std::to_string(marker.id), 0.03);
  }
  for (const Handle& handle : map.handles) {
    addAxes(*panel, handle.T_panel_handle(), handle.length_m);
    addName(*panel, handle.position_panel + Vector3d(0.01, 0.01, handle.length_m), handle.id, 0.03);
  }
  panel->setPose(toMrpt(map.T_odom_panel));
  return panel;
}

/// The panel's centre in the origin, its face towards an azimuth of 45 degrees.
Pose T_scene_odom(const Pose& T_odom_panel) {
  const Vector3d face = T_odom_panel.rotation.col(2);
  const double azimuth = face.head<2>().norm() > 1e-3 ? std::atan2(face.y(), face.x()) : 0.0;
  const Matrix3d R_scene_odom = rotationFromYawPitchRoll(radians(45) - azimuth, 0, 0);
  return {R_scene_odom, -(R_scene_odom * T_odom_panel.position)};
}

}  // namespace

gl::CSetOfObjects::Ptr panelsInOdom(const std::vector<PanelMap>& panels) {
  auto odom = gl::CSetOfObjects::Create();
  odom->setName("odom");
  if (!panels.empty()) odom->setPose(toMrpt(T_scene_odom(panels.front().T_odom_panel)));
  addAxes(*odom, {}, 1.0);
  addName(*odom, {0.05, 0.05, 0.0}, "odom", 0.2);
  for (const PanelMap& panel : panels) odom->insert(panelObject(panel));
  return odom;
}

gl::COpenGLScene panelScene(const std::vector<PanelMap>& panels) {
  gl::COpenGLScene scene;
  scene.insert(panelsInOdom(panels));
  return scene;
}

}  // namespace fathom
