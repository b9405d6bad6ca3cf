#include "evaluation/timed_detection.h"

#include <ctime>

namespace fathom {
namespace {

double threadCpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

TimedDetection detectTimed(Detector& detector, const cv::Mat& image) {
  const double begin_s = threadCpu_s();
  TimedDetection timed{detector.detect(image)};
  timed.cpu_s = threadCpu_s() - begin_s;
  return timed;
}

}  // namespace fathom
