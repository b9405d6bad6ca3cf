#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fiducials/detector.h"

namespace fathom {

struct TimedDetection {
  std::vector<Detection> detections;
  double cpu_s = 0;  ///< of this thread; measured, so another one each time
};
TimedDetection detectTimed(Detector& detector, const cv::Mat& image);

}  // namespace fathom
