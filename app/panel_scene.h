#pragma once

#include <mrpt/opengl/COpenGLScene.h>

#include "panel/panel_map.h"

namespace fathom {

/// Panels for MRPT's SceneViewer3D: the surfaces in their colours, odom's and the panels' axes, and at each
/// marker and handle its frame and its name. All of it is in one object, named `odom`, within which
/// coordinates are odom's. The viewer knows no camera but its own, which looks at the origin from x = y:
/// therefore that object is moved and turned about the vertical, which puts the first panel there and lets
/// its face look at the viewer. There must be a panel.
mrpt::opengl::COpenGLScene panelScene(const std::vector<PanelMap>& panels);

}  // namespace fathom
