#include "environment/water_camera.h"

#include "image_files/jpeg.h"

namespace fathom {
namespace {

// Far from the streams of recordings' noise, and of the pairs'.
std::uint64_t noiseStream(std::size_t image) { return std::uint64_t{3} << 61 | image; }

}  // namespace

cv::Mat WaterCamera::image(const PosedImage& posed, const View& clean, const Environment& environment,
                           double log_gain) const {
  const CameraStudio& studio = maker_.studio();
  const CameraShot shot = posed.shot();
  Random noise = Random::stream(seed_, noiseStream(posed.number));
  const cv::Mat light = studio.lightIn(environment, shot, clean) * std::exp(log_gain);
  return throughJpeg(studio.exposeLight(shot, light, &noise), jpeg_quality_);
}

}  // namespace fathom
