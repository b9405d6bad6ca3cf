#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "observables/clean_pair.h"
#include "observables/patches.h"

/// Patches of many images.
namespace fathom {

struct RejectedImage {
  std::filesystem::path file;
  std::string why;
};

/// What images give, or those that are fitted on.
struct SynchronizedImages {
  std::vector<std::size_t> images;  ///< indices into the posed ones; a patch's image is an index into these
  std::vector<Patch> patches;
  std::vector<RejectedImage> rejected;
  std::size_t saturated = 0, dark = 0;  ///< patches with a channel that does not count
};

/// Which patch each pixel of an image belongs to, see patchesOf(). For many threads at once.
using Labelling = std::function<cv::Mat(const PosedImage&, const View& clean)>;
/// Looks at an image and its rendering, as long as they are there, and how they are cut into patches: at the
/// i-th of the posed ones. Likewise.
using Look = std::function<void(std::size_t i, const CleanPair&, const cv::Mat& labels, const PatchOptions&)>;

/// Renders these posed images and takes patches of them, all cores at once. Without a labelling, squares.
/// `look` is at those of which there are patches. Throws Interrupted.
SynchronizedImages synchronize(const std::vector<PosedImage>& posed, const std::vector<std::size_t>& images,
                               const CleanPairMaker& maker, const Labelling& labelsOf = {},
                               const Look& look = {});

}  // namespace fathom
