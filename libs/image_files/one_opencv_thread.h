#pragma once

#include <opencv2/core.hpp>

namespace fathom {

/// While it lives, OpenCV works in the thread that calls it: what it takes is that thread's time, and images,
/// not parts of one, are spread over the cores.
class OneOpenCvThread {
 public:
  OneOpenCvThread() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OneOpenCvThread() { cv::setNumThreads(before_); }
  OneOpenCvThread(const OneOpenCvThread&) = delete;
  OneOpenCvThread& operator=(const OneOpenCvThread&) = delete;

 private:
  int before_;
};

}  // namespace fathom
