#include "support/videos.h"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

namespace fathom::test {

cv::Mat videoFrame(int k) {
  constexpr int kSide_px = 40, kStep_px = 83;
  std::array<double, kVideoWidth_px> across{};
  for (int u = 0; u < kVideoWidth_px; ++u)
    across[static_cast<std::size_t>(u)] = 40 * std::sin(0.02 * (u + 3 * k));
  cv::Mat frame(kVideoHeight_px, kVideoWidth_px, CV_8UC3);
  for (int v = 0; v < frame.rows; ++v) {
    const double down = 90 + 30 * std::cos(0.03 * v);
    auto* row = frame.ptr<cv::Vec3b>(v);
    for (const double wave : across) {
      const double gray = down + wave;
      *row++ = {cv::saturate_cast<uchar>(gray), cv::saturate_cast<uchar>(0.8 * gray),
                cv::saturate_cast<uchar>(200 - gray)};
    }
  }
  cv::rectangle(frame, {kStep_px * k % (kVideoWidth_px - kSide_px), 100, kSide_px, kSide_px},
                cv::Scalar::all(255), cv::FILLED);
  return frame;
}

void writeVideo(const std::filesystem::path& file, const std::string& codec, int frames) {
  constexpr double kRate_hz = 25;
  // Motion JPEG by OpenCV's own encoder, the others by FFmpeg's.
  const int by = codec == "MJPG" ? cv::CAP_OPENCV_MJPEG : cv::CAP_FFMPEG;
  cv::VideoWriter writer(file.string(), by, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]),
                         kRate_hz, {kVideoWidth_px, kVideoHeight_px});
  if (!writer.isOpened()) throw std::runtime_error(codec + " cannot be written");
  for (int k = 0; k < frames; ++k) writer.write(videoFrame(k));
}

}  // namespace fathom::test
