#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "environment/fsim_search.h"
#include "environment/image_choice.h"
#include "environment/panel_pose_check.h"
#include "environment/water_fit.h"
#include "environment/water_scores.h"

/// Task T_E on a recording: the water fitted to some of its images, the paper's search as baseline, and both
/// judged on images that neither has seen.
namespace fathom {

struct WaterStudyOptions {
  ImageChoiceOptions choice;
  WaterFitOptions fit;  ///< its start is the default water
  FsimSearchOptions search;
  std::size_t search_images = 5;
  PanelPoseCheckOptions panel_poses;
  std::uint64_t seed = 1;
};

struct RejectedImage {
  std::filesystem::path file;
  std::string why;
};

/// What the images to fit on give.
struct SynchronizedImages {
  std::vector<std::size_t> images;  ///< indices into the posed ones; a patch's image is an index into these
  std::vector<Patch> patches;
  std::vector<RejectedImage> rejected;
  std::size_t saturated = 0, dark = 0;  ///< patches with a channel that does not count
};

struct WaterStudy {
  std::size_t images = 0, posed = 0;  ///< of the recording
  ImageChoice choice;
  SynchronizedImages synchronized;
  std::optional<int> jpeg_quality;
  WaterFit fit;
  FsimSearch search;
  std::vector<WaterCandidate>
      candidates;               ///< default, the paper's search, fitted, and where it is known truth
  std::size_t recommended = 0;  ///< one of the first three
  std::optional<Environment> truth;
  std::optional<PanelPoseCheck> panel_poses;  ///< under the recommended water
  cv::Mat sheet;                              ///< CV_8UC3: some held-out images as recorded and in each water
  std::vector<std::string> remarks;

  const WaterCandidate& recommendedWater() const { return candidates[recommended]; }
};

/// Which patch each pixel of an image belongs to, see patchesOf(). For many threads at once.
using Labelling = std::function<cv::Mat(const PosedImage&, const View& clean)>;
/// Looks at an image and its rendering, as long as they are there, and how they are cut into patches: at the
/// i-th of the posed ones. Likewise.
using Look = std::function<void(std::size_t i, const CleanPair&, const cv::Mat& labels, const PatchOptions&)>;

/// Renders these posed images and takes patches of them, all cores at once. Without a labelling, squares.
/// `look` is at those of which there are patches. Throws Interrupted.
SynchronizedImages synchronize(const std::vector<PosedImage>& posed, const std::vector<std::size_t>& images,
                               const PairMaker& maker, const Labelling& labelsOf = {}, const Look& look = {});

/// `maker` renders, with the effects of its world, which the images must have been posed with; its
/// environment does not matter, lamps are off but for effects. Throws Error where no image can be used: no
/// marker in any, or none fits its pose (the first one's reason); Interrupted.
WaterStudy studyWater(const std::filesystem::path& rawlog, const PosedImages& images, const PairMaker& maker,
                      const WaterStudyOptions& options);

/// A water file that readEnvironment() takes; `comment` becomes its first lines.
std::string formatEnvironment(const Environment& environment, const std::string& comment);

}  // namespace fathom
