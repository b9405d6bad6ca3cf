#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "core/files.h"

namespace fathom {

/// Pictures as a film that every player opens: Motion JPEG in AVI, by OpenCV's own encoder, so no codec is
/// needed. Written aside and renamed by finish(); the same pictures give the same bytes.
class PairVideo {
 public:
  static constexpr double kPicturesPerSecond = 10;

  explicit PairVideo(const std::filesystem::path& file) : file_(file) {}

  /// All of one size; of another, it is scaled to the first one's. Throws Error where the file cannot be
  /// written.
  void write(const cv::Mat& picture_bgr);
  /// Nothing where there was no picture. Throws Error.
  void finish();

 private:
  PendingFile file_;
  cv::VideoWriter writer_;
  cv::Size size_;
};

}  // namespace fathom
