#pragma once

#include "observables/clean_pair.h"
#include "observables/patches.h"

/// Where an image shows nothing but water: what comes from there is the veil alone.
namespace fathom {

/// A patch for each cell of the image, four to a row and three rows, labelled from 0 on, in which enough
/// lines of sight rise so steeply that they leave the sea floor for good, and meet none of what is rendered:
/// black, at kOpenWater_m. `rays` as raysOf() the camera that took the image.
std::vector<Patch> openWaterOf(const CleanPair& pair, const cv::Mat& rays, const Matrix3d& R_odom_camera,
                               const CameraSheet& sheet, int margin_px = PatchOptions{}.margin_px);

}  // namespace fathom
