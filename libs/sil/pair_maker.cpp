#include "sil/pair_maker.h"

#include <algorithm>
#include <array>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/error.h"
#include "core/text.h"
#include "fiducials/image_file.h"
#include "fiducials/jpeg.h"
#include "fiducials/single_marker_pose.h"
#include "imaging/camera_geometry.h"
#include "imaging/fingerprints.h"
#include "imaging/true_panel.h"
#include "render/scene.h"
#include "similarity/measures.h"
#include "simulation/simulate_recording.h"

namespace fathom {
namespace {

/// Random streams of image k, far from those with which `simulate` made a recording: noise that a recording
/// was made with must not come out again.
std::uint64_t noiseStream(std::size_t image) { return std::uint64_t{1} << 62 | image; }
/// Flakes, too, are others than the recording's.
std::uint64_t particleSeed(std::uint64_t seed) { return seed ^ std::uint64_t{1} << 62; }

/// Checked; with a camera of 8 bits, as recordings have them.
SilWorld usable(SilWorld world) {
  if (!world.vehicle.camera || world.panels.empty())
    throw std::invalid_argument("pairs need a camera and a panel");
  world.vehicle.camera->bits = 8;
  return world;
}

CameraWorld worldOf(const SilWorld& world) {
  CameraWorld seen{world.panels, {}, world.environment};
  if (const auto& floor = world.sea_floor)
    seen.sea_floor_odom = seaFloorBelow(world.panels, floor->z_m, sandOf(floor->sand_seed));
  return seen;
}

/// Root mean square distance of a detection's corners from where the pose puts the marker's; infinite behind
/// the camera.
double offset_px(const Detection& detection, const std::array<Vector3d, 4>& corners_camera,
                 const CameraProjector<double>& projector) {
  double squares = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (corners_camera[k].z() <= 0) return std::numeric_limits<double>::infinity();
    squares += (projector.project(corners_camera[k]) - detection.corners_px[k]).squaredNorm();
  }
  return std::sqrt(squares / 4);
}

}  // namespace

PairMaker::PairMaker(SilWorld world, const PairOptions& options, DetectionSettings detection)
    : world_(usable(std::move(world))),
      options_(options),
      detection_(std::move(detection)),
      studio_(worldOf(world_), camera(), world_.vehicle.lamps, world_.effects) {}

Detector& PairMaker::detectorOf(const CameraModel& camera) const {
  auto& detector = detectors_.local()[fingerprintOf(camera)];
  if (!detector) detector = detectorFor(camera, detection_);
  return *detector;
}

cv::Mat PairMaker::panelMask(const PosedImage& posed, const View& view) const {
  cv::Mat mask = studio_.panelMask(posed.shot(), view);
  if (cv::countNonZero(mask) == 0)
    throw Error(posed.image.file.string(), "", "no panel is in view from where it was taken");
  return mask;
}

void PairMaker::requireOwnPose(const PosedImage& posed) const {
  std::vector<double> offsets_px;
  const Pose T_camera_odom = posed.T_odom_camera().inverse();
  for (const PanelMap& panel : world_.panels) {
    const Pose T_camera_panel = T_camera_odom * truePanelPose(panel, world_.effects, posed.t_s);
    for (const Detection& detection : posed.detections)
      if (const Marker* marker = markerOf(detection, panel)) {
        auto corners = markerCorners_panel(*marker, world_.effects, posed.t_s);
        for (Vector3d& corner : corners) corner = T_camera_panel * corner;
        offsets_px.push_back(offset_px(detection, corners, posed.camera.projector));
      }
  }
  if (offsets_px.empty()) return;
  const auto middle = offsets_px.begin() + static_cast<std::ptrdiff_t>((offsets_px.size() - 1) / 2);
  std::nth_element(offsets_px.begin(), middle, offsets_px.end());
  if (*middle <= options_.largest_offset_px) return;
  const std::string where =
      std::isfinite(*middle) ? print("%.0f px from where it has them", *middle) : "behind the camera";
  throw Error(posed.image.file.string(), "", "the pose is not this image's: its markers lie " + where);
}

SilPair PairMaker::make(const PosedImage& posed) const {
  const cv::Mat recorded = readImage(posed.image.file, posed.image.camera);
  requireOwnPose(posed);
  CameraShot shot = posed.shot();
  shot.particle_seed = particleSeed(options_.seed);
  const View view = studio_.render(shot);
  Random noise = Random::stream(options_.seed, noiseStream(posed.number));

  SilPair pair;
  pair.images.camera = &camera();
  pair.images.panel_mask = panelMask(posed, view);
  cv::Mat simulated = studio_.expose(shot, view, options_.noise ? &noise : nullptr);
  if (recorded.channels() == 1) cv::cvtColor(simulated, simulated, cv::COLOR_BGR2GRAY);
  simulated = throughJpeg(simulated, jpegQuality(posed.image.file));
  pair.images.recorded = inColour(recorded);
  pair.images.simulated = inColour(simulated);
  pair.images.recorded_detections = posed.detections;
  pair.images.simulated_detections = detectorOf(posed.image.camera).detect(simulated);
  if (const auto why = whyNotComparable(pair.images); !why.empty())
    throw Error(posed.image.file.string(), "", why);

  const Pose T_panel_camera = world_.panels.at(posed.panel).T_odom_panel.inverse() * posed.T_odom_camera();
  pair.range_m = T_panel_camera.position.norm();
  pair.view_angle_rad = std::acos(std::clamp(T_panel_camera.position.z() / pair.range_m, -1.0, 1.0));
  pair.panel_share = cv::countNonZero(pair.images.panel_mask) / static_cast<double>(recorded.total());
  return pair;
}

CleanPair PairMaker::clean(const PosedImage& posed) const {
  CleanPair pair{inColour(readImage(posed.image.file, posed.image.camera)), {}, {}};
  requireOwnPose(posed);
  pair.clean = studio_.renderAlbedo(posed.shot());
  pair.panel_mask = panelMask(posed, pair.clean);
  return pair;
}

ImagePair PairMaker::compared(const ImagePair& images) const {
  if (world_.sea_floor) return images;
  ImagePair result = images;
  result.recorded = images.simulated.clone();
  images.recorded.copyTo(result.recorded, images.panel_mask);
  return result;
}

cv::Mat PairMaker::comparedRegion(const ImagePair& images) const {
  if (!world_.sea_floor) return images.panel_mask;
  return {images.panel_mask.size(), CV_8UC1, cv::Scalar(255)};
}

cv::Mat inColour(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace fathom
