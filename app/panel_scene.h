#pragma once

#include <mrpt/opengl/COpenGLScene.h>

#include "panel/panel_map.h"

namespace fathom {

/// The panel in odom for MRPT's SceneViewer3D: the surface in its colours, odom's and the panel's axes, and
/// at each marker and handle its frame and its name. The scene's own camera looks at the panel from eye_odom.
mrpt::opengl::COpenGLScene panelScene(const PanelMap& map, const Vector3d& eye_odom);

}  // namespace fathom
