#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

/// Videos whose frames are known.
namespace fathom::test {

inline constexpr int kVideoWidth_px = 320, kVideoHeight_px = 240;

/// Waves that move on, and a white square at another place in each frame, so that none is taken for the one
/// beside it: PSNR below 25 dB.
cv::Mat videoFrame(int k);

/// That many of them, 25 a second. `codec`: "MJPG", "mp4v", "avc1". Throws std::runtime_error where OpenCV
/// cannot write it.
void writeVideo(const std::filesystem::path& file, const std::string& codec, int frames);

}  // namespace fathom::test
