#pragma once

#include <vector>

#include "environment/water_study.h"
#include "imaging/image_patch.h"
#include "imaging/marine_snow.h"
#include "imaging/marker_blur.h"

/// The images of a whole recording, reduced to what a diagnosis of the image can see: white and black of each
/// marker, the panel's body piece by piece, and open water, each a patch with place, albedo, and what the
/// camera read; how soft each marker's edges are; and how many specks there are on plain surfaces.
namespace fathom {

struct ImagePatches {
  std::vector<ImagePatch> patches;  ///< panels' by image, then open water's; stamps are since `time_zero`
  std::vector<MarkerBlur> blurs;    ///< by image
  std::vector<ImageSpecks> specks;  ///< by image
  Environment start;                ///< the base model's water fitted to them, lamps off
  std::vector<RejectedImage> rejected;
};

/// All cores at once. No patches where no water can be fitted to them. `open_water`: whether there is nothing
/// else above the horizon and beside the panels. Throws Interrupted.
ImagePatches imagePatches(const std::vector<PosedImage>& posed, const PairMaker& maker, Time time_zero,
                          bool open_water = true);

}  // namespace fathom
