#include "environment/water_camera.h"

#include "fiducials/jpeg.h"

namespace fathom {
namespace {

// Far from the streams of recordings' noise, and of the pairs'.
std::uint64_t noiseStream(std::size_t image) { return std::uint64_t{3} << 61 | image; }

CameraSheet ofEightBits(CameraSheet sheet, const CameraModel& model) {
  sheet.bits = 8;
  sheet.model = model;
  return sheet;
}

}  // namespace

WaterCamera::WaterCamera(CameraSheet sheet, const CameraModel& model, std::optional<int> jpeg_quality,
                         std::uint64_t seed)
    : sheet_(ofEightBits(std::move(sheet), model)),
      model_(sheet_, Water{}),
      jpeg_quality_(jpeg_quality),
      seed_(seed) {}

cv::Mat WaterCamera::image(const View& clean, const Environment& environment, std::size_t number,
                           double log_gain) const {
  const Vector3d& ambient = environment.ambient;
  const cv::Mat scene = clean.radiance.mul(cv::Scalar(ambient[0], ambient[1], ambient[2]));
  Random noise = Random::stream(seed_, noiseStream(number));
  const cv::Mat light = model_.in(environment.water).light(scene, clean.range_m) * std::exp(log_gain);
  return throughJpeg(model_.expose(light, &noise), jpeg_quality_);
}

}  // namespace fathom
