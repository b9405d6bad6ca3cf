#include "panel_scene.h"

#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTriangles.h>
#include <mrpt/opengl/CText.h>
#include <mrpt/opengl/stock_objects.h>

#include <cmath>

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

/// Axes with a name beside them.
void addFrame(gl::CSetOfObjects& parent, const Pose& T_parent_frame, float size_m, const std::string& name) {
  auto axes = gl::stock_objects::CornerXYZSimple(size_m, 2.0f);
  axes->setPose(T_parent_frame.toMrpt());
  parent.insert(axes);
  auto label = gl::CText::Create(name);
  label->setFont("sans", 14);
  label->setColor_u8(mrpt::img::TColor(0, 0, 0));
  label->setLocation((T_parent_frame * Vector3d(0, 0, 1.2 * size_m)).cast<float>().x(),
                     (T_parent_frame * Vector3d(0, 0, 1.2 * size_m)).cast<float>().y(),
                     (T_parent_frame * Vector3d(0, 0, 1.2 * size_m)).cast<float>().z());
  parent.insert(label);
}

gl::CSetOfObjects::Ptr panelObject(const PanelMap& map) {
  auto panel = gl::CSetOfObjects::Create();
  panel->setName("panel " + map.name);
  panel->insert(triangles(surfaceOf(map)));
  addFrame(*panel, {}, 0.2f, "panel");
  for (const Marker& marker : map.markers)
    addFrame(*panel, marker.T_panel_marker, static_cast<float>(0.4 * marker.size_m),
             std::to_string(marker.id));
  for (const Handle& handle : map.handles)
    addFrame(*panel, handle.T_panel_handle(), static_cast<float>(0.1 + 0.5 * handle.length_m), handle.id);
  panel->setPose(map.T_odom_panel.toMrpt());
  return panel;
}

void lookAt(gl::CCamera& camera, const Vector3d& centre, const Vector3d& eye) {
  const Vector3d way = eye - centre;
  camera.setPointingAt(static_cast<float>(centre.x()), static_cast<float>(centre.y()),
                       static_cast<float>(centre.z()));
  camera.setZoomDistance(static_cast<float>(way.norm()));
  camera.setAzimuthDegrees(static_cast<float>(degrees(std::atan2(way.y(), way.x()))));
  camera.setElevationDegrees(static_cast<float>(degrees(std::atan2(way.z(), way.head<2>().norm()))));
}

}  // namespace

gl::COpenGLScene panelScene(const PanelMap& map, const Vector3d& eye_odom) {
  gl::COpenGLScene scene;
  auto odom = gl::CSetOfObjects::Create();
  odom->setName("odom");
  addFrame(*odom, {}, 1.0f, "odom");
  scene.insert(odom);
  scene.insert(panelObject(map));
  lookAt(scene.getViewport()->getCamera(), map.T_odom_panel.position, eye_odom);
  return scene;
}

}  // namespace fathom
