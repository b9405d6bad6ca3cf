#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace fathom {

/// What a video's header says.
struct VideoHeader {
  int width_px = 0, height_px = 0;  ///< as stored
  std::string codec;                ///< four characters: "avc1", "hvc1", "MJPG"; empty where it has none
  double rate_hz = 0;               ///< frames a second; 0 where it does not say
  std::int64_t frames = 0;  ///< of some containers an estimate by length and rate; 0 where it does not say
  int rotation_deg = 0;     ///< that players turn frames by; which way round depends on OpenCV's version
};

/// The frames of a video file that FFmpeg decodes (H.264, H.265, MPEG-4, Motion JPEG, …), one after another,
/// by OpenCV. As stored: a rotation that the header asks of players is not applied, for the camera's
/// calibration is for the stored grid. One at a time: FFmpeg has one place for its complaints, which are
/// caught here instead of printed.
class VideoFrames {
 public:
  /// Throws Error where the file cannot be read or is no video.
  explicit VideoFrames(std::filesystem::path file);
  ~VideoFrames();
  VideoFrames(const VideoFrames&) = delete;
  VideoFrames& operator=(const VideoFrames&) = delete;

  const VideoHeader& header() const;
  /// Decodes the next frame; false behind the last. Throws Error, with the frame, at the first complaint of
  /// the decoder's: it hides damage by what it guesses. It works ahead, so damage may lie a few frames on.
  /// A few bytes that only decode to another picture no decoder sees: most codecs have no checksums.
  bool next();
  /// Of the frame decoded last, from 0 on.
  std::int64_t frame() const;
  /// That frame, CV_8UC3, blue, green, red. Throws Error.
  cv::Mat image();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fathom
