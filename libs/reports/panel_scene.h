#pragma once

#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>

#include <vector>

#include "panel/panel_map.h"

namespace fathom {

/// Panels for MRPT's SceneViewer3D: the surfaces in their colours, odom's and the panels' axes, and at each
/// marker and handle its frame and its name. All of it is in this one object, named `odom`, within which
/// coordinates are odom's. The viewer knows no camera but its own, which looks at the origin from x = y:
/// therefore the object is moved and turned about the vertical, which puts the first panel there and lets its
/// face look at the viewer. Without a panel it stays where it is.
mrpt::opengl::CSetOfObjects::Ptr panelsInOdom(const std::vector<PanelMap>& panels);

/// A scene of that alone.
mrpt::opengl::COpenGLScene panelScene(const std::vector<PanelMap>& panels);

}  // namespace fathom
