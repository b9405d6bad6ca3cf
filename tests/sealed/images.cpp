#include "images.h"

#include <opencv2/imgcodecs.hpp>

#include "bent_light.h"
#include "core/files.h"
#include "core/for_each.h"
#include "corners.h"
#include "drifting.h"
#include "lamp_light.h"
#include "manipulator.h"
#include "picture.h"
#include "streams.h"

namespace fathom::sealed {

ImageMaker::ImageMaker(const Vehicle& vehicle, const SealedCase& sealed, const TruePanel& panel,
                       const Viewpoint& viewpoint)
    : vehicle_(vehicle),
      sealed_(sealed),
      panel_(panel),
      viewpoint_(viewpoint),
      paint_(panel, sealed),
      exposure_(vehicle, sealed) {}

cv::Mat3b ImageMaker::take(std::size_t index, double stamp_s) const {
  Random random = stream(sealed_.seed, Stream::first_image, index);
  const double log_sun = random.normal(), log_gain = random.normal();
  const Camera& camera = vehicle_.camera;
  const SightLines sight(TrueCamera(camera, sealed_, stamp_s), camera.width_px, camera.height_px);
  WaterLight water = waterLightAt(sealed_, stamp_s, log_sun);
  water.cloud = murkyCloudAt(sealed_, viewpoint_, panel_.T_odom_panel(stamp_s).position, stamp_s);
  const LampLight lamps(vehicle_, sealed_.number("lamp", "irradiance_1m_rel", stamp_s), water,
                        waterLightAt(sealed_, stamp_s, 0).daylight, sight, lampPhase(sealed_, stamp_s),
                        sealed_.number("lamp", "beam_exponent", stamp_s));
  const PaintedPanel painted(panel_, paint_, stamp_s);
  const HiddenEffect* blur = sealed_.find("motion-blur", stamp_s);
  const double exposure_s = blur ? sealed_.number(blur->id, "exposure_s", stamp_s) : camera.exposure_s;

  const View view{camera, sealed_, viewpoint_, panel_, painted, sight, water, lamps, stamp_s, exposure_s};
  const Picture picture = takePicture(view);
  cv::Mat3f light = withBentLight(picture, camera);
  addSnow(view, picture, light);
  addArm(view, vehicle_, light);
  addBubbles(sealed_.outsideSize("bubbles"), random, water, light);
  return exposure_.expose(light, sight, stamp_s, log_gain, random);
}

void writeImages(const std::filesystem::path& folder, const ImageMaker& maker,
                 const std::vector<double>& stamps_s) {
  constexpr int kQuick = 1;  // noise hardly packs
  cv::setNumThreads(1);      // an image a thread
  forEachIndex(stamps_s.size(), "images", [&](std::size_t i) {
    std::vector<unsigned char> bytes;
    cv::imencode(".png", maker.take(i, stamps_s[i]), bytes, {cv::IMWRITE_PNG_COMPRESSION, kQuick});
    writeTextFile(folder / imageName(i), std::string(bytes.begin(), bytes.end()));
  });
}

}  // namespace fathom::sealed
