#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "imaging/image_patch.h"
#include "imaging/image_texture.h"
#include "imaging/marine_snow.h"
#include "imaging/marker_blur.h"
#include "observables/synchronized_images.h"

/// The images of a whole recording, reduced to what a diagnosis of the image can see: white and black of each
/// marker, the panel's body piece by piece, and open water, each a patch with place, albedo, and what the
/// camera read; how soft each marker's edges are; how many specks there are on plain surfaces, and
/// what interpolated colours and compression leave in the noise of these.
namespace fathom {

struct ImagePatches {
  std::vector<ImagePatch> patches;  ///< panels' by image, then open water's; stamps are since `time_zero`
  std::vector<MarkerBlur> blurs;    ///< by image
  std::vector<ImageSpecks> specks;  ///< by image
  /// By image. Which pixels measure green is the same in all: their chessboard counts as on the pixels whose
  /// coordinates add up to an odd number, unless all images together say clearly that it is on the others.
  std::vector<ImageTexture> textures;
  Environment start;  ///< the base model's water fitted to them, lamps off
  std::vector<RejectedImage> rejected;
};

/// Fits the base model's water to patches; nothing where it cannot.
using StartWater = std::function<std::optional<Environment>(const SynchronizedImages&)>;

/// All cores at once. No patches where `startWater` has no water for them. `open_water`: whether there is
/// nothing else above the horizon and beside the panels. Throws Interrupted.
ImagePatches imagePatches(const std::vector<PosedImage>& posed, const CleanPairMaker& maker, Time time_zero,
                          const StartWater& startWater, bool open_water = true);

}  // namespace fathom
