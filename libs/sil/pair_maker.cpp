#include "sil/pair_maker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "image_files/jpeg.h"
#include "imaging/fingerprints.h"
#include "similarity/measures.h"

namespace fathom {
namespace {

/// Random streams of image k, far from those with which `simulate` made a recording: noise that a recording
/// was made with must not come out again.
std::uint64_t noiseStream(std::size_t image) { return std::uint64_t{1} << 62 | image; }
/// Flakes, too, are others than the recording's.
std::uint64_t particleSeed(std::uint64_t seed) { return seed ^ std::uint64_t{1} << 62; }

}  // namespace

PairMaker::PairMaker(KnownWorld world, const PairOptions& options, DetectionSettings detection)
    : CleanPairMaker(std::move(world), options.largest_offset_px),
      options_(options),
      detection_(std::move(detection)) {}

Detector& PairMaker::detectorOf(const CameraModel& camera) const {
  auto& detector = detectors_.local()[fingerprintOf(camera)];
  if (!detector) detector = detectorFor(camera, detection_);
  return *detector;
}

SilPair PairMaker::make(const PosedImage& posed) const {
  const cv::Mat recorded = readRecorded(posed.image.file, posed.image.camera);
  requireOwnPose(posed);
  CameraShot shot = posed.shot();
  shot.particle_seed = particleSeed(options_.seed);
  const View view = studio().render(shot);
  Random noise = Random::stream(options_.seed, noiseStream(posed.number));

  SilPair pair;
  pair.images.camera = &camera();
  pair.images.panel_mask = panelMask(posed, view);
  cv::Mat simulated = studio().expose(shot, view, options_.noise ? &noise : nullptr);
  if (recorded.channels() == 1) cv::cvtColor(simulated, simulated, cv::COLOR_BGR2GRAY);
  simulated = throughJpeg(simulated, jpegQuality(posed.image.file));
  pair.images.recorded = inColour(recorded);
  pair.images.simulated = inColour(simulated);
  pair.images.recorded_detections = posed.detections;
  pair.images.simulated_detections = detectorOf(posed.image.camera).detect(simulated);
  if (const auto why = whyNotComparable(pair.images); !why.empty())
    throw Error(posed.image.file.string(), "", why);

  const Pose T_panel_camera = world().panels.at(posed.panel).T_odom_panel.inverse() * posed.T_odom_camera();
  pair.range_m = T_panel_camera.position.norm();
  pair.view_angle_rad = std::acos(std::clamp(T_panel_camera.position.z() / pair.range_m, -1.0, 1.0));
  pair.panel_share = cv::countNonZero(pair.images.panel_mask) / static_cast<double>(recorded.total());
  return pair;
}

ImagePair PairMaker::compared(const ImagePair& images) const {
  if (world().sea_floor) return images;
  ImagePair result = images;
  result.recorded = images.simulated.clone();
  images.recorded.copyTo(result.recorded, images.panel_mask);
  return result;
}

cv::Mat PairMaker::comparedRegion(const ImagePair& images) const {
  if (!world().sea_floor) return images.panel_mask;
  return {images.panel_mask.size(), CV_8UC1, cv::Scalar(255)};
}

}  // namespace fathom
