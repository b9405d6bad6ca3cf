#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace fathom {

/// Pictures as a film that every player opens: Motion JPEG in AVI, by OpenCV's own encoder, so no codec is
/// needed. Written aside and renamed by finish(); the same pictures give the same bytes.
class PairVideo {
 public:
  static constexpr double kPicturesPerSecond = 10;

  explicit PairVideo(std::filesystem::path file);
  ~PairVideo();  ///< without finish(): what has been written is removed
  PairVideo(const PairVideo&) = delete;
  PairVideo& operator=(const PairVideo&) = delete;

  /// All of one size; of another, it is scaled to the first one's. Throws Error where the file cannot be
  /// written.
  void write(const cv::Mat& picture_bgr);
  /// Nothing where there was no picture. Throws Error.
  void finish();

 private:
  std::filesystem::path file_, part_;  ///< the encoder wants a name that ends in .avi
  cv::VideoWriter writer_;
  cv::Size size_;
};

}  // namespace fathom
