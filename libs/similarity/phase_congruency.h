#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "similarity/inverse_transform.h"

namespace fathom {

/// Phase congruency: how well the waves that make up an image agree in phase at a pixel, from 0 (nothing
/// there) to 1 (edge, line), whatever the contrast. Kovesi, "Image Features from Phase Congruency", Videre
/// 1(3), 1999, in the form of his phasecong2 and with the constants that Zhang et al. 2011 chose for FSIM:
///
///   PC = sum_o max(E_o - T_o, 0) / sum_o sum_s A_so
///
/// over four orientations o and scales s of log-Gabor filters. A_so is the amplitude of a response, E_o the
/// scales' energy in phase, T_o what noise alone would give, judged by the median amplitude of the finest
/// scale. The image counts as periodic.
///
/// Made once for a size. Const and without hidden state, so threads may share one; a map is the same whoever
/// makes it. In single precision: within 1e-4 of double's where there is texture; where an image is plain but
/// for a few pixels, rounding is all there is to see at most places.
class PhaseCongruency {
 public:
  static constexpr int kScales = 4, kOrientations = 4;
  static constexpr double kShortestWave_px = 6, kWaveRatio = 2;  ///< of a scale to the next finer one
  static constexpr double kLongestWave_px = 48;                  ///< of the coarsest scale

  /// At least two pixels high and wide; std::invalid_argument otherwise.
  explicit PhaseCongruency(const cv::Size& size);

  /// Of an image of this size, CV_32FC1; CV_32FC1. Zero everywhere where all pixels are equal.
  /// Throws std::invalid_argument for another size or type.
  cv::Mat of(const cv::Mat& luminance) const;

 private:
  float noiseEnergy(const SplitImage& finest, int orientation) const;

  cv::Size size_;
  FilteredTransform transform_;
  std::array<cv::Mat, kScales> radial_;                 ///< CV_32FC1, of a frequency's length
  std::array<cv::Mat, kOrientations> angular_;          ///< CV_32FC1, of its direction
  std::array<double, kOrientations> noise_per_median_;  ///< T per root of the finest scale's median energy
};

}  // namespace fathom
