#pragma once

#include "imaging/camera_geometry.h"
#include "panel/surface.h"

namespace fathom {

/// What bends a camera's lines of sight or makes its rows look at different times, moved into the scene: each
/// vertex is put where a pinhole without distortion, in the camera's place, sees it in the direction in which
/// the projector has it, at the same distance. Edges that would have to be bent are divided until straight
/// ones do to a twentieth of a pixel. What lies behind the camera or far beside the image stays where it is.
Surface apparentScene(const Surface& scene_odom, const Pose& T_odom_camera,
                      const CameraProjector<double>& projector);

}  // namespace fathom
