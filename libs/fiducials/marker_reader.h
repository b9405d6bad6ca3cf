#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fiducials/detection.h"

/// What a backend must do; used within this room only. The rest (regions, scale, refinement, order) is
/// common, see detector.cpp.
namespace fathom {

class MarkerReader {
 public:
  virtual ~MarkerReader() = default;
  /// Markers in a CV_8UC1 image, corners in our order and pixel convention, not refined, with a guess of
  /// their covariance. `smallest_side_px` is 0 where it is not known.
  virtual std::vector<Detection> read(const cv::Mat& gray, double smallest_side_px) = 0;
};

/// `border_width`: of the black border, cells; 2 for families with a plain border only.
std::unique_ptr<MarkerReader> makeArucoReader(const std::vector<std::string>& families,
                                              int largest_corrected_bits, int border_width);
std::unique_ptr<MarkerReader> makeAprilTagReader(const std::vector<std::string>& families,
                                                 int largest_corrected_bits, int border_width);

/// The smallest Hamming distance of two codes, as the family's library states it: 11 for tag36h11.
int hammingDistance(const std::string& family);
/// How many wrong bits may be forgiven: without taking one code for another, times OpenCV's caution of 0.6;
/// and so that under one in a hundred random words is taken for a code.
int correctableBits(const std::string& family, int largest);

}  // namespace fathom
