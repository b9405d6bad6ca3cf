#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/camera_model.h"
#include "imaging/lamps.h"

namespace fathom {

/// lampsInWater() of every pixel: tabulated over the image and range, interpolated in between.
class LampGlow {
 public:
  LampGlow(const CameraModel& camera, const Pose& T_robot_camera, const std::vector<LampSheet>& lamps,
           const Environment& environment, double asymmetry = 0);

  /// `range_m`: CV_32FC1 along the lines of sight, infinite where nothing is hit. CV_32FC3, red green blue.
  cv::Mat upTo(const cv::Mat& range_m) const;

 private:
  static constexpr int kCell_px = 16, kRanges = 96;

  const cv::Vec3f& at(int row, int column, int range) const {
    return table_[static_cast<std::size_t>((row * columns_ + column) * kRanges + range)];
  }

  int rows_, columns_;
  std::vector<cv::Vec3f> table_;  ///< by row, column, share of range, see rangeShare()
};

}  // namespace fathom
