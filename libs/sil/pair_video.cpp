#include "sil/pair_video.h"

#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/error.h"
#include "core/files.h"

namespace fathom {

PairVideo::PairVideo(std::filesystem::path file) : file_(std::move(file)), part_(file_) {
  part_.replace_extension(".part.avi");
}

PairVideo::~PairVideo() {
  writer_.release();
  std::error_code absent;
  std::filesystem::remove(part_, absent);
}

void PairVideo::write(const cv::Mat& picture_bgr) {
  if (!writer_.isOpened()) {
    size_ = picture_bgr.size();
    if (!writer_.open(part_.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                      kPicturesPerSecond, size_))
      throw Error(file_.string(), "", "cannot be written");
  }
  cv::Mat fitting = picture_bgr;
  if (picture_bgr.size() != size_) cv::resize(picture_bgr, fitting, size_, 0, 0, cv::INTER_AREA);
  writer_.write(fitting);
}

void PairVideo::finish() {
  if (!writer_.isOpened()) return;
  writer_.release();
  PendingFile whole(file_);
  std::error_code problem;
  std::filesystem::rename(part_, whole.path(), problem);
  if (problem) throw Error(file_.string(), "", "cannot be written: " + problem.message());
  whole.commit();
}

}  // namespace fathom
