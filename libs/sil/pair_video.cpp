#include "sil/pair_video.h"

#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

void PairVideo::write(const cv::Mat& picture_bgr) {
  if (!writer_.isOpened()) {
    size_ = picture_bgr.size();
    if (!writer_.open(file_.path().string(), cv::CAP_OPENCV_MJPEG,
                      cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), kPicturesPerSecond, size_))
      throw Error(file_.target().string(), "", "cannot be written");
  }
  cv::Mat fitting = picture_bgr;
  if (picture_bgr.size() != size_) cv::resize(picture_bgr, fitting, size_, 0, 0, cv::INTER_AREA);
  writer_.write(fitting);
}

void PairVideo::finish() {
  if (!writer_.isOpened()) return;
  writer_.release();
  file_.commit();
}

}  // namespace fathom
