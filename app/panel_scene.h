#pragma once

#include <mrpt/opengl/COpenGLScene.h>

#include "panel/panel_map.h"

namespace fathom {

/// The panel for MRPT's SceneViewer3D: the surface in its colours, odom's and the panel's axes, and at each
/// marker and handle its frame and its name. All of it is in one object, named `odom`, within which
/// coordinates are odom's. The viewer knows no camera but its own, which looks at the origin from x = y:
/// therefore that object is moved and turned about the vertical, which puts the panel there and lets its face
/// look at the viewer.
mrpt::opengl::COpenGLScene panelScene(const PanelMap& map);

}  // namespace fathom
