#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "environment/water_camera.h"
#include "similarity/fsim.h"

/// How like the recording a water makes the simulation.
namespace fathom {

/// Of one image. NaN where nothing can be compared.
struct WaterScore {
  double fsim = std::numeric_limits<double>::quiet_NaN();
  double fsimc = std::numeric_limits<double>::quiet_NaN();
  double rmse = std::numeric_limits<double>::quiet_NaN();  ///< of linear light on the panels, of full scale
};

/// A water that is judged.
struct WaterCandidate {
  std::string name;
  Environment environment;
  std::vector<WaterScore> scores;  ///< of the images, in order
};

/// Mean over images, and half the width of its 95 % confidence interval (normal, images independent).
struct MeanScore {
  std::size_t count = 0;
  double mean = std::numeric_limits<double>::quiet_NaN(),
         half_width = std::numeric_limits<double>::quiet_NaN();
};
MeanScore meanOf(const std::vector<double>& values);
MeanScore meanScore(const WaterCandidate& candidate, double WaterScore::*measure);
/// Of the difference a - b on the same images.
MeanScore meanDifference(const WaterCandidate& a, const WaterCandidate& b, double WaterScore::*measure);

/// What FSIM compares: all of the picture where the sea floor is known, otherwise the panels only, the
/// recorded image being replaced by the simulated one around them (as PairMaker::compared()).
ImagePair comparedPair(const PairMaker& maker, const CleanPair& pair, const cv::Mat& simulated);

/// Scores one image in each water. Where exposure varies (`fit_gain`), each water gets the one gain with
/// which it comes nearest on the panels.
std::vector<WaterScore> scoreImage(const PairMaker& maker, const WaterCamera& camera,
                                   const FsimComparer& fsim, const PosedImage& posed, const CleanPair& pair,
                                   const std::vector<Environment>& waters, bool fit_gain);

/// The index of the water to recommend: that of the smallest mean RMSE of linear light; among those which are
/// not told from it (95 % of the paired difference), that of the largest mean FSIM. (FSIM alone hardly sees
/// contrast and colour: a water of seven times the RMSE can have the larger one.) `eligible` candidates are
/// the first ones.
std::size_t recommended(const std::vector<WaterCandidate>& candidates, std::size_t eligible);

}  // namespace fathom
