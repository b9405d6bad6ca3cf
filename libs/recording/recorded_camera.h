#pragma once

#include <mrpt/img/TCamera.h>

#include "core/camera_model.h"

namespace fathom {

/// A recording's intrinsics as a camera model: the plumb-bob part of MRPT's.
inline CameraModel cameraModel(const mrpt::img::TCamera& camera) {
  return {static_cast<int>(camera.ncols),
          static_cast<int>(camera.nrows),
          camera.fx(),
          camera.fy(),
          camera.cx(),
          camera.cy(),
          camera.k1(),
          camera.k2(),
          camera.p1(),
          camera.p2(),
          camera.k3()};
}

}  // namespace fathom
