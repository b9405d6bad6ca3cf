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

/// The inverse.
inline mrpt::img::TCamera recordedCamera(const CameraModel& model) {
  mrpt::img::TCamera camera;
  camera.ncols = static_cast<std::uint32_t>(model.width_px);
  camera.nrows = static_cast<std::uint32_t>(model.height_px);
  camera.setIntrinsicParamsFromValues(model.fx_px, model.fy_px, model.cx_px, model.cy_px);
  camera.setDistortionPlumbBob(model.k1, model.k2, model.p1, model.p2, model.k3);
  return camera;
}

}  // namespace fathom
